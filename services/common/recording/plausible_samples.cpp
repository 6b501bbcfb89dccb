#include "services/common/recording/plausible_samples.hpp"

#include <algorithm>
#include <span>

#include "sealwatch/core/test_limits.hpp"
#include "services/common/recording/columns.hpp"
#include "services/common/text/numbers.hpp"

namespace sealwatch {
namespace {

Status check_column(std::span<double> values, const std::string& name, const std::string& unit, double largest,
                    std::size_t first_row) {
  for (std::size_t row = 0; row < values.size(); ++row) {
    const auto number = plausible(values[row], largest);
    if (!number)
      return fail(error_at("row " + std::to_string(first_row + row) + ", column " + name, text::general(values[row]),
                           "cannot be measured here: more than " + text::general(largest) + " " + unit,
                           "take the row out, or mend what wrote it"));
    values[row] = *number;
  }
  return {};
}

}  // namespace

Status check_plausible(TimeSeries& samples, const PlantDescription& plant, std::size_t first_row) {
  if (Status time = check_column(samples.time_s, "time", "s", kTestLimits.largest_time_s, first_row); !time)
    return time;
  for (Series& channel : samples.channels) {
    const auto known = std::ranges::find(plant.channels, channel.name, &ChannelDescription::name);
    const bool found = known != plant.channels.end();
    const double largest = found ? largest_plausible(known->range_min, known->range_max) : kLargestOfAnyChannel;
    if (Status checked = check_column(channel.values, channel.name, channel.unit, largest, first_row); !checked)
      return checked;
  }
  if (const auto beyond = beyond_limits(samples.time_s, samples.channels.size()))
    return fail(error_at("column time", {}, *beyond, "one recording is one test: split it, or record fewer rows"));
  return {};
}

}  // namespace sealwatch

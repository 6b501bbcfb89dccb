#include "services/common/mismatch/recorded_units.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "services/common/mismatch/telling.hpp"

namespace sealwatch::mismatch {

namespace {

std::string outside_of_its_range(const PlantDescription& plant, const TimeSeries& samples) {
  constexpr double kFarOutside = 2.0;  // ranges: further than any offset takes a sensor
  for (const Series& series : samples.channels) {
    const ChannelDescription* channel = plant.find_channel(series.name);
    if (channel == nullptr || channel->range_max <= channel->range_min) continue;
    const double reach = kFarOutside * (channel->range_max - channel->range_min);
    const double low = channel->range_min - reach, high = channel->range_max + reach;
    const auto outside =
        std::ranges::count_if(series.values, [&](double value) { return value < low || value > high; });
    if (outside == 0 || 2 * outside < static_cast<std::ptrdiff_t>(series.values.size())) continue;
    const auto far = std::ranges::max_element(series.values, {}, [](double value) { return std::abs(value); });
    return "column " + series.name + " goes to " + number(*far) + " " + channel->unit +
           ", such a channel stays within " + number(channel->range_min) + " to " + number(channel->range_max) + " " +
           channel->unit;
  }
  return {};
}

double span(const std::vector<double>& values) {
  const auto [low, high] = std::ranges::minmax(values);
  return high - low;
}

std::string position_and_velocity(const TimeSeries& samples) {
  constexpr double kFactor = 10.0, kMoves_m = 2e-3;  // less may be drift of what is summed
  const Series* position = samples.find("position");
  const Series* velocity = samples.find("velocity");
  if (position == nullptr || velocity == nullptr || samples.time_s.size() < 2) return {};
  std::vector<double> way{0.0};
  for (std::size_t k = 1; k < samples.time_s.size(); ++k)
    way.push_back(way.back() +
                  0.5 * (velocity->values[k] + velocity->values[k - 1]) * (samples.time_s[k] - samples.time_s[k - 1]));
  const double moved = span(position->values), summed = span(way);
  if (!(std::max(moved, summed) > kMoves_m) || (moved < kFactor * summed && summed < kFactor * moved)) return {};
  return "column position moves " + number(moved) + " m while column velocity adds up to " + number(summed) + " m";
}

}  // namespace

std::string another_unit(const PlantDescription& plant, const TimeSeries& samples) {
  const std::string outside = outside_of_its_range(plant, samples);
  return outside.empty() ? position_and_velocity(samples) : outside;
}

std::string hardly_moves(const PooledFit& fit) {
  constexpr double kTenTimesLess_percent = -900.0;  // of the recorded course reproduced
  const auto least = std::ranges::min_element(fit.channels, {}, &ChannelComparison::nrmse_before);
  if (least == fit.channels.end() || !(least->nrmse_before < kTenTimesLess_percent)) return {};
  return "the simulation's " + in_words(least->channel) + " moves some " +
         number(1.0 - least->nrmse_before / 100.0, 2) +
         " times as much as the recorded one: check the unit in the header of column " + least->channel;
}

}  // namespace sealwatch::mismatch

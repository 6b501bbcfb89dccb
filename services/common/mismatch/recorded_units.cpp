#include "services/common/mismatch/recorded_units.hpp"

#include <algorithm>

#include "services/common/mismatch/telling.hpp"

namespace sealwatch::mismatch {

std::string outside_of_its_range(const PlantDescription& plant, const Data& data) {
  constexpr double kFarOutside = 2.0;  // ranges: further than any test or offset takes a sensor
  double worst = kFarOutside;
  std::string text;
  for (std::size_t k = 0; k < data.samples.size(); ++k)
    for (const Series& series : data.samples[k].channels) {
      const ChannelDescription* channel = plant.find_channel(series.name);
      if (channel == nullptr || channel->range_max <= channel->range_min) continue;
      for (const double value : series.values) {
        const double range = channel->range_max - channel->range_min;
        const double outside = std::max(channel->range_min - value, value - channel->range_max) / range;
        if (!(outside > worst)) continue;
        worst = outside;
        text = "column " + series.name + " of " + data.names[k] + " goes to " + number(value) + " " + channel->unit +
               ", such a channel stays within " + number(channel->range_min) + " to " + number(channel->range_max) +
               ": check the unit in its header";
      }
    }
  return text;
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

#include "services/common/mismatch/recorded_units.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

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

using Course = Eigen::ArrayXd;

// Without its mean and its drift: a velocity's offset adds up to a drift of the way.
Course without_drift(Course values, const Course& time) {
  values -= values.mean();
  return values - (values * time).sum() / time.square().sum() * time;
}

// Both courses are one and the same but for a factor of more than ten.
std::string position_and_velocity(const PlantDescription& plant, const TimeSeries& samples) {
  constexpr double kFactor = 10.0, kAlike = 0.95;  // of the ways; their correlation
  const Series* position = find_series(samples, plant, ChannelRole::stroke);
  const Series* velocity = find_series(samples, plant, ChannelRole::speed);
  const auto rows = static_cast<Eigen::Index>(samples.time_s.size());
  if (position == nullptr || velocity == nullptr || rows < 3) return {};
  Course time = Eigen::Map<const Course>(samples.time_s.data(), rows), way(rows);
  way(0) = 0.0;
  for (Eigen::Index k = 1; k < rows; ++k) {
    const auto at = static_cast<std::size_t>(k);
    way(k) = way(k - 1) + 0.5 * (velocity->values[at] + velocity->values[at - 1]) * (time(k) - time(k - 1));
  }
  time -= time.mean();
  // What is left of the two by rounding alone says nothing.
  const double rounding = std::numeric_limits<double>::epsilon() * static_cast<double>(rows);
  const double least_way = rounding * way.abs().maxCoeff(),
               least_position = rounding * Eigen::Map<const Course>(position->values.data(), rows).abs().maxCoeff();
  const Course x = without_drift(Eigen::Map<const Course>(position->values.data(), rows), time);
  way = without_drift(way, time);
  const double moved = std::sqrt(x.square().mean()), summed = std::sqrt(way.square().mean());
  if (moved <= least_position || summed <= least_way) return {};
  const bool alike = (x * way).mean() > kAlike * moved * summed;
  if (!alike || (moved < kFactor * summed && summed < kFactor * moved)) return {};
  return "column " + position->name + " moves " + number(moved / summed, 2) + " times as far as column " +
         velocity->name + " adds up to";
}

}  // namespace

std::string another_unit(const PlantDescription& plant, const TimeSeries& samples) {
  const std::string outside = outside_of_its_range(plant, samples);
  return outside.empty() ? position_and_velocity(plant, samples) : outside;
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

#include "sealwatch/signal/test_record.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "sealwatch/signal/statistics.hpp"
#include "services/common/text/format.hpp"

namespace sealwatch::signal {
namespace {

constexpr double kCutoff_Hz = 5.0;           // strokes take seconds, sensor lags at most 50 ms
constexpr double kCutoffShare = 1.0 / 8.0;   // of the sample rate, for slow recordings
constexpr double kEdge_s = 0.3;              // at either end of a stroke's middle
constexpr double kEdgeShare = 0.2;           // but not more than this share of it
constexpr double kSettling_s = 0.5;          // after a stroke
constexpr double kBefore_s = 0.2;            // before the next stroke: effort and filter reach back
constexpr double kShortest_s = 0.3;          // a shorter range says nothing
constexpr double kSteady = 0.95;             // share of the stroke's median speed
constexpr double kLeastSpeed_std = 5.0;      // slower than this many noise deviations is no motion
constexpr double kLeastTravelShare = 0.005;  // of the cylinder's whole stroke
constexpr double kLeastTravel_std = 20.0;    // noise deviations of position

double cutoff_Hz(double interval_s) { return std::min(kCutoff_Hz, kCutoffShare / interval_s); }

/// Standard deviation of the derivative of smoothed white noise of standard deviation 1.
double derivative_noise_gain(const LowPass& filter, double interval_s) {
  const std::size_t half = filter.settling_samples();
  std::vector<double> impulse(2 * half + 1, 0.0);
  impulse[half] = 1.0;
  double square = 0.0;
  for (const double value : derivative(filter.apply_zero_phase(impulse), interval_s)) square += value * value;
  return std::sqrt(square);
}

/// The phase's direction of motion does not matter here: speed is what counts.
std::vector<double> speeds(std::span<const double> velocity, Range range) {
  std::vector<double> result(range.size());
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = std::abs(velocity[range.begin + i]);
  return result;
}

}  // namespace

TestRecord::TestRecord(const TimeSeries& samples, Cylinder cylinder, const PlantDescription& plant)
    : samples_(samples),
      cylinder_(cylinder),
      plant_(&plant),
      interval_s_((samples.time_s.back() - samples.time_s.front()) / static_cast<double>(samples.time_s.size() - 1)),
      filter_(LowPass::butterworth(2, cutoff_Hz(interval_s_), 1.0 / interval_s_)) {
  assert(samples.time_s.size() >= 8);
  filter_description_ = text::format(
      "phases and features: 2nd-order Butterworth low-pass at {:.3g} Hz forward and backward, zero phase; the window "
      "itself is not filtered",
      cutoff_Hz(interval_s_));
  smooth_channels();
  find_load_pressure();
  find_motion();
  if (!velocity_.empty()) phases_ = segment_phases(motion());
}

void TestRecord::smooth_channels() {
  for (const Series& channel : samples_.channels) smooth_[channel.name] = filter_.apply_zero_phase(channel.values);
}

void TestRecord::find_load_pressure() {
  const std::vector<double>* pressure_a = raw(ChannelRole::pressure_up);
  const std::vector<double>* pressure_b = raw(ChannelRole::pressure_down);
  if (pressure_a && pressure_b) {
    load_pressure_ = *pressure_a;
    for (std::size_t i = 0; i < load_pressure_.size(); ++i)
      load_pressure_[i] -= cylinder_.area_ratio * (*pressure_b)[i];
  } else if (const std::vector<double>* differential = raw(ChannelRole::pressure_difference)) {
    load_pressure_ = *differential;
  }
  if (!load_pressure_.empty()) smooth_load_pressure_ = filter_.apply_zero_phase(load_pressure_);
}

void TestRecord::find_motion() {
  if (const std::vector<double>* position = smooth(ChannelRole::stroke)) {
    position_ = *position;
    velocity_ = derivative(position_, interval_s_);
    velocity_noise_std_ =
        find_series(samples_, *plant_, ChannelRole::stroke)->noise_std * derivative_noise_gain(filter_, interval_s_);
  } else if (const std::vector<double>* velocity = smooth(ChannelRole::speed)) {
    velocity_ = *velocity;
    position_ = integral(velocity_, interval_s_);
    velocity_noise_std_ = smooth_noise_std(ChannelRole::speed);
  }
}

Motion TestRecord::motion() const {
  const double position_noise =
      raw(ChannelRole::stroke) ? kLeastTravel_std * smooth_noise_std(ChannelRole::stroke) : 0.0;
  Motion motion{.begin_s = samples_.time_s.front(),
                .interval_s = interval_s_,
                .velocity_m_s = velocity_,
                .effort = {},
                .least_speed_m_s = kLeastSpeed_std * velocity_noise_std_,
                .least_travel_m = std::max(kLeastTravelShare * cylinder_.stroke_m, position_noise)};
  if (!smooth_load_pressure_.empty()) motion.effort.push_back(smooth_load_pressure_);
  if (const std::vector<double>* values = smooth(ChannelRole::drive)) motion.effort.push_back(*values);
  return motion;
}

const std::vector<double>* TestRecord::raw(ChannelRole channel) const {
  const Series* series = find_series(samples_, *plant_, channel);
  return series ? &series->values : nullptr;
}

const std::vector<double>* TestRecord::smooth(ChannelRole channel) const {
  const auto found = smooth_.find(channel_name(*plant_, channel));
  return found == smooth_.end() ? nullptr : &found->second;
}

double TestRecord::smooth_noise_std(ChannelRole channel) const {
  const Series* series = find_series(samples_, *plant_, channel);
  return series ? series->noise_std * filter_.zero_phase_noise_gain() : 0.0;
}

Range TestRecord::range(const MotionPhase& phase) const {
  const double begin_s = samples_.time_s.front();
  const auto index = [&](double time_s) {
    const double place = std::round((time_s - begin_s) / interval_s_);
    return std::min(static_cast<std::size_t>(std::max(place, 0.0)), samples_.time_s.size());
  };
  return {index(phase.begin_s), index(phase.end_s)};
}

std::optional<Range> TestRecord::middle(const MotionPhase& stroke) const {
  const Range whole = range(stroke);
  if (whole.size() < 4) return std::nullopt;
  const double steady = kSteady * median(speeds(velocity_, whole));
  Range middle = whole;
  while (middle.begin < middle.end && std::abs(velocity_[middle.begin]) < steady) ++middle.begin;
  while (middle.begin < middle.end && std::abs(velocity_[middle.end - 1]) < steady) --middle.end;
  const double edge_s = std::min(kEdge_s, kEdgeShare * interval_s_ * static_cast<double>(middle.size()));
  const auto edge = static_cast<std::size_t>(std::ceil(edge_s / interval_s_));
  const auto shortest = static_cast<std::size_t>(std::ceil(kShortest_s / interval_s_));
  if (middle.size() < 2 * edge + std::max<std::size_t>(shortest, 4)) return std::nullopt;
  return Range{middle.begin + edge, middle.end - edge};
}

std::optional<Range> TestRecord::settled(const MotionPhase& standstill) const {
  Range range = this->range(standstill);
  if (standstill.kind == MotionKind::hold)
    range.begin += static_cast<std::size_t>(std::ceil(kSettling_s / interval_s_));
  const auto before = static_cast<std::size_t>(std::ceil(kBefore_s / interval_s_));
  const auto shortest = static_cast<std::size_t>(std::ceil(kShortest_s / interval_s_));
  range.end -= std::min(before, range.end);
  if (range.end < range.begin + std::max<std::size_t>(shortest, 4)) return std::nullopt;
  return range;
}

}  // namespace sealwatch::signal

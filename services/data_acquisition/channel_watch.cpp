#include "services/data_acquisition/channel_watch.hpp"

#include <cmath>
#include <numbers>

#include "services/common/text/format.hpp"

namespace sealwatch {
namespace {

constexpr double kMovedShare = 0.02;                      // of the stroke
constexpr double kMovedAngle_rad = 2 * std::numbers::pi;  // one revolution
constexpr double kCoarseSteps = 2.0;  // steps of more than this many noise deviations hide the noise

bool is_slow(const ChannelDescription& channel) { return channel.unit == "K"; }

bool is_kinematic(const ChannelDescription& channel) {
  return channel.unit == "m" || channel.unit == "m/s" || channel.unit == "rad" || channel.unit == "rad/s";
}

std::array<bool, kWitnesses> witnesses_for(const ChannelDescription& channel) {
  //                                            position  velocity  pump_angle  shaft_speed
  if (channel.role == ChannelRole::stroke) return {false, true, false, false};
  if (channel.role == ChannelRole::speed) return {true, false, false, false};
  if (channel.role == ChannelRole::shaft_angle) return {true, false, false, true};
  if (channel.role == ChannelRole::shaft_speed) return {true, false, true, false};
  return {true, true, false, false};
}

}  // namespace

ChannelWatch::ChannelWatch(const ChannelDescription& channel, const SensorSetting& sensor, double stroke_m)
    : name_(channel.name),
      unit_(channel.unit),
      judged_(!channel.input && !is_slow(channel)),
      witness_(witnesses_for(channel)),
      stroke_m_(stroke_m) {
  const bool own_range = sensor.range_max > sensor.range_min;
  range_min_ = own_range ? sensor.range_min : channel.range_min;
  range_max_ = own_range ? sensor.range_max : channel.range_max;
  const double noise_std = sensor.noise_std > 0.0 ? sensor.noise_std : channel.noise_std;
  noise_rule_ = !is_kinematic(channel) && noise_std > 0.0 && sensor.quantisation <= kCoarseSteps * noise_std;
}

void ChannelWatch::add(double time_s, double value, const Travel& travel, const DataAcquisitionOptions& options) {
  ++count_;
  if (!std::isfinite(value)) {
    ++not_a_number_;
    interrupt();
    return;
  }
  check_range(time_s, value);
  extend_run(time_s, value, travel);
  if (judged_ && run_.count > frozen_.count && frozen(time_s, options))
    frozen_ = {.value = value, .begin_s = run_.begin_s, .end_s = time_s, .count = run_.count};
}

void ChannelWatch::check_range(double time_s, double value) {
  if (range_max_ <= range_min_ || (value >= range_min_ && value <= range_max_)) return;
  const double middle = 0.5 * (range_min_ + range_max_);
  if (out_of_range_ == 0 || std::abs(value - middle) > std::abs(worst_ - middle)) worst_ = value, worst_s_ = time_s;
  ++out_of_range_;
}

void ChannelWatch::extend_run(double time_s, double value, const Travel& travel) {
  if (run_.count == 0 || value != run_.value)
    run_ = {.value = value, .begin_s = time_s, .count = 0, .least = travel, .most = travel};
  ++run_.count;
  for (std::size_t i = 0; i < kWitnesses; ++i) {
    run_.least[i] = std::fmin(run_.least[i], travel[i]);  // fmin and fmax pass over NaN
    run_.most[i] = std::fmax(run_.most[i], travel[i]);
  }
}

bool ChannelWatch::moved() const {
  for (std::size_t i = 0; i < kWitnesses; ++i) {
    const bool angle =
        i == static_cast<std::size_t>(Witness::pump_angle) || i == static_cast<std::size_t>(Witness::shaft_speed);
    const double least = angle ? kMovedAngle_rad : kMovedShare * stroke_m_;
    if (witness_[i] && run_.most[i] - run_.least[i] > least) return true;  // false for NaN
  }
  return false;
}

bool ChannelWatch::frozen(double time_s, const DataAcquisitionOptions& options) const {
  if (run_.count < options.least_frozen_samples || time_s - run_.begin_s < options.least_frozen_s) return false;
  return (noise_rule_ && run_.value != 0.0) || moved();
}

std::string ChannelWatch::frozen_reason() const {
  return text::format("frozen at {:.5g} {} for {:.2f} s from {:.2f} s", frozen_.value, unit_,
                      frozen_.end_s - frozen_.begin_s, frozen_.begin_s);
}

std::string ChannelWatch::range_reason() const {
  return text::format("{} of {} samples out of range {:.5g}..{:.5g} {}, worst {:.5g} at {:.2f} s", out_of_range_,
                      count_, range_min_, range_max_, unit_, worst_, worst_s_);
}

ChannelStatus ChannelWatch::status(const DataAcquisitionOptions& options) const {
  ChannelStatus status{.channel = name_, .state = ChannelState::OK, .reason = {}};
  if (count_ == 0) return {.channel = name_, .state = ChannelState::NOT_USED, .reason = "not recorded"};
  const auto note = [&status](const std::string& reason, bool failed) {
    status.reason += (status.reason.empty() ? "" : "; ") + reason;
    if (failed) status.state = ChannelState::FAILED;
    if (!failed && status.state == ChannelState::OK) status.state = ChannelState::UNKNOWN;
  };
  const double least_failed = options.failed_share * static_cast<double>(count_);
  if (frozen_.count > 0) note(frozen_reason(), true);
  if (out_of_range_ > 0) note(range_reason(), static_cast<double>(out_of_range_) > least_failed);
  if (not_a_number_ > 0)
    note(text::format("{} of {} samples are not a number that a sensor gives", not_a_number_, count_),
         static_cast<double>(not_a_number_) > least_failed);
  return status;
}

}  // namespace sealwatch

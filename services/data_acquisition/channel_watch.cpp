#include "services/data_acquisition/channel_watch.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "services/common/text/format.hpp"
#include "services/common/text/words.hpp"

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

/// What each witness must have moved; those that say nothing of the channel, never.
std::vector<double> least_moves(const ChannelDescription& channel, double stroke_m) {
  const std::array<bool, kWitnesses> speaks = witnesses_for(channel);
  std::vector<double> least = {kMovedShare * stroke_m, kMovedShare * stroke_m, kMovedAngle_rad, kMovedAngle_rad};
  for (std::size_t i = 0; i < kWitnesses; ++i)
    if (!speaks[i]) least[i] = std::numeric_limits<double>::infinity();
  return least;
}

signal::StuckRule rule_for(const ChannelDescription& channel, const SensorSetting& sensor,
                           const DataAcquisitionOptions& options) {
  const double noise_std = sensor.noise_std > 0.0 ? sensor.noise_std : channel.noise_std;
  return {.least_samples = options.least_frozen_samples,
          .least_s = options.least_frozen_s,
          .noise_shows = !is_kinematic(channel) && noise_std > 0.0 && sensor.quantisation <= kCoarseSteps * noise_std};
}

}  // namespace

ChannelWatch::ChannelWatch(const ChannelDescription& channel, const SensorSetting& sensor, double stroke_m,
                           const DataAcquisitionOptions& options)
    : name_(channel.name),
      unit_(channel.unit),
      judged_(!channel.input && !is_slow(channel)),
      stuck_(rule_for(channel, sensor, options), least_moves(channel, stroke_m)) {
  const bool own_range = sensor.range_max > sensor.range_min;
  range_min_ = own_range ? sensor.range_min : channel.range_min;
  range_max_ = own_range ? sensor.range_max : channel.range_max;
}

void ChannelWatch::add(double time_s, double value, const Travel& travel) {
  ++count_;
  stuck_.add(time_s, value, travel);
  if (std::isfinite(value))
    check_range(time_s, value);
  else
    ++not_a_number_;
}

void ChannelWatch::check_range(double time_s, double value) {
  if (range_max_ <= range_min_ || (value >= range_min_ && value <= range_max_)) return;
  const double middle = 0.5 * (range_min_ + range_max_);
  if (out_of_range_ == 0 || std::abs(value - middle) > std::abs(worst_ - middle)) worst_ = value, worst_s_ = time_s;
  ++out_of_range_;
}

std::string ChannelWatch::range_reason() const {
  return text::format("{} of {} samples out of range {:.5g}..{:.5g} {}, worst {:.5g} at {:.2f} s", out_of_range_,
                      count_, range_min_, range_max_, unit_, worst_, worst_s_);
}

ChannelStatus ChannelWatch::status(const DataAcquisitionOptions& options) const {
  ChannelStatus status{.channel = name_, .state = ChannelState::OK, .reason = {}};
  if (count_ == 0) return {.channel = name_, .state = ChannelState::NOT_USED, .reason = "not recorded"};
  const auto note = [&status](const std::string& reason, bool failed) {
    text::add_to_list(status.reason, reason, "; ");
    if (failed) status.state = ChannelState::FAILED;
    if (!failed && status.state == ChannelState::OK) status.state = ChannelState::UNKNOWN;
  };
  const double least_failed = options.failed_share * static_cast<double>(count_);
  if (const auto run = stuck_.stuck(); judged_ && run)
    note(text::format("frozen at {:.5g} {} for {:.2f} s from {:.2f} s", run->value, unit_, run->end_s - run->begin_s,
                      run->begin_s),
         true);
  if (out_of_range_ > 0) note(range_reason(), static_cast<double>(out_of_range_) > least_failed);
  if (not_a_number_ > 0)
    note(text::format("{} of {} samples are not a number that a sensor gives", not_a_number_, count_),
         static_cast<double>(not_a_number_) > least_failed);
  return status;
}

}  // namespace sealwatch

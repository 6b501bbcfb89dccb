#include "services/data_manipulation/alignment_check.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "sealwatch/signal/alignment.hpp"
#include "sealwatch/signal/filters.hpp"
#include "sealwatch/signal/statistics.hpp"
#include "services/common/text/format.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch {
namespace {

constexpr double kCutoff_Hz = 5.0;
constexpr double kCutoffShare = 1.0 / 8.0;

/// One channel's comparison with the reference.
struct Comparison {
  std::string channel;
  signal::OffsetEstimate estimate;
  bool timed = false;  ///< whether its time is comparable, not only its sign
};

class AlignmentCheck {
 public:
  AlignmentCheck(const TimeSeries& samples, const AssetView& asset, const DataManipulationOptions& options)
      : samples_(samples),
        asset_(asset),
        options_(options),
        interval_s_((samples.time_s.back() - samples.time_s.front()) / static_cast<double>(samples.time_s.size() - 1)),
        filter_(signal::LowPass::butterworth(2, std::min(kCutoff_Hz, kCutoffShare / interval_s_), 1.0 / interval_s_)) {}

  Alignment run() {
    compare_motion();
    judge_signs();
    judge_offsets();
    compare_pressures();
    return std::move(alignment_);
  }

 private:
  void compare_motion();
  [[nodiscard]] std::vector<double> speed_by_flow(const std::vector<double>& speed, double mean_position_m) const;
  void judge_signs();
  void judge_offsets();
  void compare_pressures();
  void compare_with_leakage(const Series& differential);
  [[nodiscard]] std::optional<signal::OffsetEstimate> compare(const std::vector<double>& reference,
                                                              double reference_lag_s, const Series& channel) const;
  [[nodiscard]] bool offset_noticed(double offset_s, double std_s) const;
  void note_sign(const std::string& channel, bool correct, const std::string& why);
  void note_offset(const std::string& channel, double offset_s, double std_s, bool correct, const std::string& why);
  AlignmentRemark& remark(const std::string& channel);
  [[nodiscard]] const Series* recorded(ChannelRole role) const {
    return find_series(samples_, asset_.described(), role);
  }
  [[nodiscard]] std::string name(ChannelRole role) const { return channel_name(asset_.described(), role); }

  const TimeSeries& samples_;
  const AssetView& asset_;
  const DataManipulationOptions& options_;
  double interval_s_;
  signal::LowPass filter_;
  std::vector<Comparison> comparisons_;  ///< with dx/dt
  Alignment alignment_;
};

AlignmentRemark& AlignmentCheck::remark(const std::string& channel) {
  for (AlignmentRemark& one : alignment_.remarks)
    if (one.channel == channel) return one;
  AlignmentRemark fresh;
  fresh.channel = channel;
  return alignment_.remarks.emplace_back(std::move(fresh));
}

void AlignmentCheck::note_sign(const std::string& channel, bool correct, const std::string& why) {
  AlignmentRemark& one = remark(channel);
  one.sign_swapped = true;
  one.corrected = one.corrected || correct;
  text::add_to_list(one.remark, "sign swapped: " + why, "; ");
  if (correct) alignment_.corrections[channel].swap_sign = true;
}

void AlignmentCheck::note_offset(const std::string& channel, double offset_s, double std_s, bool correct,
                                 const std::string& why) {
  AlignmentRemark& one = remark(channel);
  one.time_offset_s = offset_s;
  one.time_offset_std_s = std_s;
  one.corrected = one.corrected || correct;
  text::add_to_list(one.remark,
                    text::format("{:.0f} ± {:.0f} ms {}: {}", 1e3 * std::abs(offset_s), 1e3 * std_s,
                                 offset_s > 0.0 ? "late" : "early", why),
                    "; ");
  if (correct) alignment_.corrections[channel].shift_s = offset_s;
}

/// Both sides get each other's sensor lag, so that what is left is no sensor's doing.
std::optional<signal::OffsetEstimate> AlignmentCheck::compare(const std::vector<double>& reference,
                                                              double reference_lag_s, const Series& channel) const {
  const std::vector<double> smooth = filter_.apply_zero_phase(channel.values);
  return signal::estimate_offset(signal::first_order_lag(reference, asset_.time_constant_s(channel.name), interval_s_),
                                 signal::first_order_lag(smooth, reference_lag_s, interval_s_), interval_s_,
                                 options_.largest_offset_s);
}

/// Speed of the piston that the flow would show: dx/dt + V_A / (beta A_A) dp_A/dt. Compression makes the flow lead.
std::vector<double> AlignmentCheck::speed_by_flow(const std::vector<double>& speed, double mean_position_m) const {
  const signal::Cylinder cylinder = asset_.cylinder();
  const Series* pressure = recorded(ChannelRole::pressure_up);
  const double share = pressure ? 1.0 : 0.5;  // the chambers share a change of their difference
  if (!pressure) pressure = recorded(ChannelRole::pressure_difference);
  if (!pressure || !cylinder.area_a_m2 || !cylinder.bulk_modulus_Pa) return speed;
  const double volume_m3 = cylinder.dead_volume_m3.value_or(0.0) + *cylinder.area_a_m2 * mean_position_m;
  const double capacity_m_Pa = share * volume_m3 / (*cylinder.bulk_modulus_Pa * *cylinder.area_a_m2);
  const std::vector<double> rate = signal::derivative(filter_.apply_zero_phase(pressure->values), interval_s_);
  std::vector<double> result = speed;
  for (std::size_t i = 0; i < result.size(); ++i) result[i] += capacity_m_Pa * rate[i];
  return result;
}

void AlignmentCheck::compare_motion() {
  const Series* position = recorded(ChannelRole::stroke);
  if (!position) return;
  const std::vector<double> speed = signal::derivative(filter_.apply_zero_phase(position->values), interval_s_);
  const std::vector<double> by_flow = speed_by_flow(speed, signal::mean(position->values).value);
  for (const ChannelRole role : {ChannelRole::speed, ChannelRole::flow, ChannelRole::shaft_speed, ChannelRole::drive}) {
    const Series* channel = recorded(role);
    if (!channel) continue;
    const std::vector<double>& reference = role == ChannelRole::flow ? by_flow : speed;
    const auto estimate = compare(reference, asset_.time_constant_s(position->name), *channel);
    if (!estimate || std::abs(estimate->correlation) < options_.least_sign_correlation) continue;
    const bool timed = role == ChannelRole::speed || role == ChannelRole::flow;
    comparisons_.push_back({channel->name, *estimate, timed});
  }
}

/// Position votes for itself; every comparison votes for or against it.
void AlignmentCheck::judge_signs() {
  std::size_t against = 0;
  for (const Comparison& one : comparisons_)
    if (one.estimate.gain < 0.0) ++against;
  if (against == 0) return;
  const std::size_t with = comparisons_.size() - against + 1;
  if (against > with) {
    note_sign(name(ChannelRole::stroke), true, "all else moves the other way; corrected");
    for (const Comparison& one : comparisons_)
      if (one.estimate.gain > 0.0) note_sign(one.channel, true, "against most other channels; corrected");
    return;
  }
  for (const Comparison& one : comparisons_) {
    if (one.estimate.gain > 0.0) continue;
    if (with > against)
      note_sign(one.channel, true, "against most other channels; corrected");
    else
      note_sign(one.channel, false, "it contradicts position, and it is unknown which of the two is wrong");
  }
}

bool AlignmentCheck::offset_noticed(double offset_s, double std_s) const {
  const double least = std::max(options_.least_offset_s, options_.least_offset_samples * interval_s_);
  return std::abs(offset_s) > options_.significance * std_s && std::abs(offset_s) > least;
}

void AlignmentCheck::judge_offsets() {
  std::vector<const Comparison*> timed;
  for (const Comparison& one : comparisons_)
    if (one.timed && std::abs(one.estimate.correlation) >= options_.least_correlation) timed.push_back(&one);
  std::vector<const Comparison*> late;
  for (const Comparison* one : timed)
    if (offset_noticed(one->estimate.offset_s, one->estimate.offset_std_s)) late.push_back(one);
  if (late.empty()) return;
  if (timed.size() == 1) {
    note_offset(late[0]->channel, late[0]->estimate.offset_s, late[0]->estimate.offset_std_s, false,
                "against position, and it is unknown which of the two is wrong");
    return;
  }
  const signal::OffsetEstimate& a = timed[0]->estimate;
  const signal::OffsetEstimate& b = timed[1]->estimate;
  const bool agree = !offset_noticed(a.offset_s - b.offset_s, std::hypot(a.offset_std_s, b.offset_std_s));
  if (late.size() == 2 && agree) {
    note_offset(name(ChannelRole::stroke), -0.5 * (a.offset_s + b.offset_s),
                0.5 * std::hypot(a.offset_std_s, b.offset_std_s), true,
                "velocity and flow agree with each other; corrected");
    return;
  }
  // One that also disagrees with the third channel is the wrong one; else the third is too unsure to be a witness.
  const bool told = late.size() == 1 && !agree;
  for (const Comparison* one : late)
    note_offset(one->channel, one->estimate.offset_s, one->estimate.offset_std_s, told,
                told ? "against the other channels; corrected"
                     : "against position, and it is unknown which of the channels is wrong");
}

/// Without the chambers' pressures: while the piston stands, oil leaks from the higher pressure to the lower, and the
/// flow that holds it has the sign of the pressure difference.
void AlignmentCheck::compare_with_leakage(const Series& differential) {
  constexpr double kStands = 0.02;     // of the largest speed
  constexpr double kLeast_s = 2.0;     // of standstill
  constexpr double kStdErrors = 10.0;  // of the mean; coloured noise and what is left of the motion are in it
  const Series* position = recorded(ChannelRole::stroke);
  const Series* flow = recorded(ChannelRole::flow);
  if (!position || !flow) return;
  const std::vector<double> speed = signal::derivative(filter_.apply_zero_phase(position->values), interval_s_);
  double largest = 0.0;
  for (const double one : speed) largest = std::max(largest, std::abs(one));
  std::vector<double> flow_at_rest, difference_at_rest;
  for (std::size_t i = 0; i < speed.size(); ++i) {
    if (std::abs(speed[i]) > kStands * largest) continue;
    flow_at_rest.push_back(flow->values[i]);
    difference_at_rest.push_back(differential.values[i]);
  }
  if (static_cast<double>(flow_at_rest.size()) * interval_s_ < kLeast_s) return;
  const signal::Estimate leak = signal::mean(flow_at_rest), difference = signal::mean(difference_at_rest);
  const bool clear = std::abs(leak.value) > kStdErrors * leak.std_error &&
                     std::abs(difference.value) > kStdErrors * difference.std_error;
  const auto correction = alignment_.corrections.find(name(ChannelRole::flow));
  const double sign = correction != alignment_.corrections.end() && correction->second.swap_sign ? -1.0 : 1.0;
  if (clear && sign * leak.value * difference.value < 0.0)
    note_sign(name(ChannelRole::pressure_difference), false,
              "against the flow that leaks while the piston stands; it, or the zero of the flow, is wrong");
}

/// Absolute pressures have no sign to swap, so that pressure_differential is the one that is wrong.
void AlignmentCheck::compare_pressures() {
  const Series* pressure_a = recorded(ChannelRole::pressure_up);
  const Series* pressure_b = recorded(ChannelRole::pressure_down);
  const Series* differential = recorded(ChannelRole::pressure_difference);
  if (!differential) return;
  if (!pressure_a || !pressure_b) {
    compare_with_leakage(*differential);
    return;
  }
  std::vector<double> difference = pressure_a->values;
  for (std::size_t i = 0; i < difference.size(); ++i) difference[i] -= pressure_b->values[i];
  const auto estimate =
      compare(filter_.apply_zero_phase(difference), asset_.time_constant_s(pressure_a->name), *differential);
  if (!estimate) return;
  if (estimate->correlation < -options_.least_sign_correlation)
    note_sign(name(ChannelRole::pressure_difference), true, "against pressure_a - pressure_b; corrected");
  if (std::abs(estimate->correlation) >= options_.least_correlation &&
      offset_noticed(estimate->offset_s, estimate->offset_std_s))
    note_offset(name(ChannelRole::pressure_difference), estimate->offset_s, estimate->offset_std_s, false,
                "against pressure_a - pressure_b, and it is unknown which is wrong");
}

}  // namespace

Alignment check_alignment(const TimeSeries& samples, const AssetView& asset, const DataManipulationOptions& options) {
  return AlignmentCheck(samples, asset, options).run();
}

}  // namespace sealwatch

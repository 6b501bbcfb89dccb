// The recorded input as a function of time: each channel linear between samples, or held until the next one.
//
// A held channel jumps; the times at which any does cut the recording into segments, within which the input is smooth
// enough for a multistep integrator. Within a segment, and shortly beyond its end, a held channel keeps the segment's
// value. Where rows were lost, up to ten of the usual distance (the median), what a moving channel was held at is not
// known: it takes steps of that distance along the line between its neighbours.
//
// What acted on the plant may differ from what was recorded:
//   u(t) = (1 + g) (u_recorded(t - tau + r (t - t_0)) - z) + b,   t = t_0 + (t_recorded - t_0) / (1 + c)
//   g gain [1], b bias [channel], tau delay [s], z zero of the reading [channel], r by how much its own clock is fast [1]
//   of one channel, c by how much the recording's clock is fast [1]
// and changes with them by
//   du/dg = u_recorded - z,   du/db = 1,   du/dtau = -u_recorded',   du/dr = (t - t_0) u_recorded'
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace sealwatch {

struct InputChannel {
  std::vector<double> values;
  bool hold = false;
  std::vector<double> slopes = {};  ///< at the samples; empty: those of the values' course
  bool cubic = false;               ///< the course between samples has these slopes; else slopes are linear
  double delay_s = 0.0, clock_rate = 0.0;
  double gain = 0.0, bias = 0.0;  ///< that the values have in them
};

/// By what the recording differs from what acted on the plant.
struct RecordingErrors {
  struct Input {
    double gain = 0.0, bias = 0.0, delay_s = 0.0, zero = 0.0, clock_rate = 0.0;
  };
  std::vector<Input> inputs;
  double clock_rate = 0.0;
};

class RecordedInput {
 public:
  RecordedInput(std::vector<double> times, std::vector<InputChannel> channels)
      : times_(std::move(times)), channels_(std::move(channels)), segments_{times_.front()} {
    for (const InputChannel& channel : channels_) {
      steps_.push_back(steps_of(channel));
      add_jumps(steps_.back());
    }
    std::ranges::sort(segments_);
    segments_.erase(std::unique(segments_.begin(), segments_.end()), segments_.end());
    for (std::size_t k = 0; k < channels_.size(); ++k) {
      held_.push_back(held_values(steps_[k]));
      const auto [least, largest] = std::ranges::minmax(channels_[k].values);
      size_.push_back(std::max(std::abs(least), std::abs(largest)));
    }
  }

  /// The input as it acted.
  [[nodiscard]] RecordedInput without(const RecordingErrors& errors) const {
    const double rate = 1.0 + errors.clock_rate;
    std::vector<double> times = times_;
    for (double& time : times) time = times_.front() + (time - times_.front()) / rate;
    std::vector<InputChannel> channels = channels_;
    for (std::size_t k = 0; k < channels.size(); ++k) {
      const auto [gain, bias, delay_s, zero, clock_rate] = errors.inputs[k];
      for (double& value : channels[k].values) value = (1.0 + gain) * (value - zero) + bias;
      for (double& slope : channels[k].slopes) slope *= (1.0 + gain) * rate;
      channels[k].delay_s = delay_s;
      channels[k].clock_rate = clock_rate;
      channels[k].gain = gain;
      channels[k].bias = bias;
    }
    RecordedInput acted(std::move(times), std::move(channels));
    acted.clock_rate_ = errors.clock_rate;
    return acted;
  }

  [[nodiscard]] const std::vector<double>& times() const { return times_; }
  [[nodiscard]] const std::vector<InputChannel>& channels() const { return channels_; }
  [[nodiscard]] double clock_rate() const { return clock_rate_; }
  /// Largest magnitude of a channel.
  [[nodiscard]] double size(std::size_t channel) const { return size_[channel]; }
  [[nodiscard]] std::size_t segment_count() const { return segments_.size(); }
  [[nodiscard]] double segment_begin(std::size_t segment) const { return segments_[segment]; }
  [[nodiscard]] double segment_end(std::size_t segment) const {
    return segment + 1 < segments_.size() ? segments_[segment + 1] : times_.back();
  }

  /// Value of a channel at time t in a segment. `cursor` remembers where the last look-up was.
  [[nodiscard]] double value(std::size_t channel, double t, std::size_t segment, std::size_t& cursor) const {
    const InputChannel& input = channels_[channel];
    if (input.hold) return held_[channel][segment];
    seek(read_at(input, t), cursor);
    const double share = share_at(read_at(input, t), cursor);
    const double linear = input.values[cursor] + share * (input.values[cursor + 1] - input.values[cursor]);
    return input.cubic ? linear + bow(input, share, cursor) : linear;
  }
  /// Slope of a channel at time t, where value() last looked; 0 where it is held.
  [[nodiscard]] double slope(std::size_t channel, double t, std::size_t cursor) const {
    const InputChannel& input = channels_[channel];
    return input.hold ? 0.0 : (1.0 + input.clock_rate) * recorded_slope(input, t, cursor);
  }

  /// d(value, slope) of a channel by its gain.
  [[nodiscard]] std::array<double, 2> by_gain(std::size_t channel, double t, std::size_t segment,
                                              std::size_t& cursor) const {
    const InputChannel& input = channels_[channel];
    const double value = this->value(channel, t, segment, cursor);
    return {(value - input.bias) / (1.0 + input.gain), slope(channel, t, cursor) / (1.0 + input.gain)};
  }
  /// d value by its delay, where it does not jump.
  [[nodiscard]] double by_delay(std::size_t channel, double t, std::size_t& cursor) const {
    const InputChannel& input = channels_[channel];
    const double then = read_at(input, t);
    if (input.hold || then < times_.front() || then > times_.back()) return 0.0;
    seek(then, cursor);
    if (input.cubic) return -recorded_slope(input, t, cursor);
    return -(input.values[cursor + 1] - input.values[cursor]) / (times_[cursor + 1] - times_[cursor]);
  }
  /// The same by the rate of its clock.
  [[nodiscard]] double by_clock_rate(std::size_t channel, double t, std::size_t& cursor) const {
    return -(t - times_.front()) * by_delay(channel, t, cursor);
  }
  /// How much later a jump of a held channel at time t comes by its delay (1 s of it), or by the rate of its clock.
  [[nodiscard]] double jump_by_delay(std::size_t channel) const { return 1.0 / (1.0 + channels_[channel].clock_rate); }
  [[nodiscard]] double jump_by_clock_rate(std::size_t channel, double t) const {
    return -(t - times_.front()) * jump_by_delay(channel);
  }

 private:
  /// When it was recorded what acts at time t.
  [[nodiscard]] double read_at(const InputChannel& input, double t) const {
    return t - input.delay_s + input.clock_rate * (t - times_.front());
  }
  /// When acts what was recorded then.
  [[nodiscard]] double acts_at(const InputChannel& input, double recorded_s) const {
    return times_.front() + (recorded_s - times_.front() + input.delay_s) / (1.0 + input.clock_rate);
  }
  [[nodiscard]] double recorded_slope(const InputChannel& input, double t, std::size_t cursor) const {
    if (!input.slopes.empty()) {
      const double share = share_at(read_at(input, t), cursor);
      const double linear = input.slopes[cursor] + share * (input.slopes[cursor + 1] - input.slopes[cursor]);
      return input.cubic ? linear + slope_of_bow(input, share, cursor) : linear;
    }
    return (input.values[cursor + 1] - input.values[cursor]) / (times_[cursor + 1] - times_[cursor]);
  }
  [[nodiscard]] double share_at(double t, std::size_t cursor) const {
    return std::clamp((t - times_[cursor]) / (times_[cursor + 1] - times_[cursor]), 0.0, 1.0);
  }
  // Hermite's cubic with the slopes at both samples, against the straight line: s (1 - s) ((1 - s) a - s b) h with a, b
  // by how much the slopes exceed the line's.
  [[nodiscard]] double bow(const InputChannel& input, double s, std::size_t k) const {
    const double h = times_[k + 1] - times_[k], line = (input.values[k + 1] - input.values[k]) / h;
    return h * s * (1.0 - s) * ((1.0 - s) * (input.slopes[k] - line) - s * (input.slopes[k + 1] - line));
  }
  // Its slope against the one that is linear between both.
  [[nodiscard]] double slope_of_bow(const InputChannel& input, double s, std::size_t k) const {
    const double line = (input.values[k + 1] - input.values[k]) / (times_[k + 1] - times_[k]);
    return 3.0 * s * (1.0 - s) * (2.0 * line - input.slopes[k] - input.slopes[k + 1]);
  }
  /// From when a held channel has a value.
  struct Step {
    double at_s;
    double value;
  };
  /// Of a held channel, rows that were lost included; none of others.
  [[nodiscard]] std::vector<Step> steps_of(const InputChannel& input) const {
    constexpr double kGap = 1.5, kMost = 10.5;  // usual distances
    std::vector<Step> steps;
    if (!input.hold) return steps;
    const double usual_s = usual_distance_s();
    for (std::size_t row = 0; row < times_.size(); ++row) {
      steps.push_back({acts_at(input, times_[row]), input.values[row]});
      if (row + 1 == times_.size()) break;
      const double gap_s = times_[row + 1] - times_[row];
      if (!(gap_s > kGap * usual_s) || gap_s > kMost * usual_s || !moves_around(input.values, row)) continue;
      const double before_s = times_[row] - times_[row - 1], after_s = times_[row + 2] - times_[row + 1];
      if (std::max(before_s, after_s) > kGap * usual_s) continue;  // a slower course, not rows that were lost
      const double rise = (input.values[row + 1] - input.values[row]) / gap_s;
      for (double s = usual_s; s < gap_s - 0.5 * usual_s; s += usual_s)
        steps.push_back({acts_at(input, times_[row] + s), input.values[row] + rise * s});
    }
    return steps;
  }
  [[nodiscard]] double usual_distance_s() const {
    std::vector<double> distances;
    for (std::size_t row = 1; row < times_.size(); ++row) distances.push_back(times_[row] - times_[row - 1]);
    if (distances.empty()) return std::numeric_limits<double>::infinity();
    const auto middle = distances.begin() + std::ssize(distances) / 2;
    std::ranges::nth_element(distances, middle);
    return *middle;
  }
  /// Before the gap that follows a row, and after it: a command that is switched stays what it is until it is seen to
  /// change.
  [[nodiscard]] static bool moves_around(const std::vector<double>& values, std::size_t row) {
    return row > 0 && row + 2 < values.size() && values[row] != values[row - 1] && values[row + 1] != values[row + 2];
  }
  void add_jumps(const std::vector<Step>& steps) {
    for (std::size_t k = 1; k < steps.size(); ++k)
      if (steps[k].value != steps[k - 1].value && steps[k].at_s > times_.front() && steps[k].at_s <= times_.back())
        segments_.push_back(steps[k].at_s);
  }
  /// Of one channel in each segment; empty where it is not held.
  [[nodiscard]] std::vector<double> held_values(const std::vector<Step>& steps) const {
    std::vector<double> values;
    std::size_t at = 0;
    for (std::size_t segment = 0; !steps.empty() && segment < segments_.size(); ++segment) {
      while (at + 1 < steps.size() && steps[at + 1].at_s <= segments_[segment]) ++at;
      values.push_back(steps[at].value);
    }
    return values;
  }
  void seek(double t, std::size_t& cursor) const {
    while (cursor + 2 < times_.size() && t >= times_[cursor + 1]) ++cursor;
    while (cursor > 0 && t < times_[cursor]) --cursor;
  }

  std::vector<double> times_;
  std::vector<InputChannel> channels_;
  std::vector<double> segments_;           ///< where each begins
  std::vector<std::vector<Step>> steps_;   ///< by channel
  std::vector<std::vector<double>> held_;  ///< by channel and segment
  std::vector<double> size_;
  double clock_rate_ = 0.0;  ///< that the times have in them
};

}  // namespace sealwatch

// The recorded input as a function of time: each channel linear between samples, or held until the next one.
//
// A held channel jumps; the times at which any does cut the recording into segments, within which the input is smooth
// enough for a multistep integrator. Within a segment, and shortly beyond its end, a held channel keeps the segment's
// value.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace sealwatch {

struct InputChannel {
  std::vector<double> values;
  bool hold = false;
  std::vector<double> slopes = {};  ///< at the samples; empty: those of the values' course
  bool cubic = false;               ///< the course between samples has these slopes; else slopes are linear
};

class RecordedInput {
 public:
  RecordedInput(std::vector<double> times, std::vector<InputChannel> channels)
      : times_(std::move(times)), channels_(std::move(channels)), segments_{0} {
    for (std::size_t row = 1; row + 1 < times_.size(); ++row)
      if (jumps(row)) segments_.push_back(row);
  }

  [[nodiscard]] const std::vector<double>& times() const { return times_; }
  [[nodiscard]] std::size_t segment_count() const { return segments_.size(); }
  [[nodiscard]] double segment_begin(std::size_t segment) const { return times_[segments_[segment]]; }
  [[nodiscard]] double segment_end(std::size_t segment) const {
    return segment + 1 < segments_.size() ? times_[segments_[segment + 1]] : times_.back();
  }

  /// Value of a channel at time t in a segment. `cursor` remembers where the last look-up was.
  [[nodiscard]] double value(std::size_t channel, double t, std::size_t segment, std::size_t& cursor) const {
    const InputChannel& input = channels_[channel];
    if (input.hold) return input.values[segments_[segment]];
    seek(t, cursor);
    const double share = share_at(t, cursor);
    const double linear = input.values[cursor] + share * (input.values[cursor + 1] - input.values[cursor]);
    return input.cubic ? linear + bow(input, share, cursor) : linear;
  }
  /// Slope of a channel at time t, where value() last looked; 0 where it is held.
  [[nodiscard]] double slope(std::size_t channel, double t, std::size_t cursor) const {
    const InputChannel& input = channels_[channel];
    if (input.hold) return 0.0;
    if (!input.slopes.empty()) {
      const double share = share_at(t, cursor);
      const double linear = input.slopes[cursor] + share * (input.slopes[cursor + 1] - input.slopes[cursor]);
      return input.cubic ? linear + slope_of_bow(input, share, cursor) : linear;
    }
    return (input.values[cursor + 1] - input.values[cursor]) / (times_[cursor + 1] - times_[cursor]);
  }

 private:
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
  [[nodiscard]] bool jumps(std::size_t row) const {
    return std::any_of(channels_.begin(), channels_.end(), [row](const InputChannel& input) {
      return input.hold && input.values[row] != input.values[row - 1];
    });
  }
  void seek(double t, std::size_t& cursor) const {
    while (cursor + 2 < times_.size() && t >= times_[cursor + 1]) ++cursor;
    while (cursor > 0 && t < times_[cursor]) --cursor;
  }

  std::vector<double> times_;
  std::vector<InputChannel> channels_;
  std::vector<std::size_t> segments_;  ///< first row of each
};

}  // namespace sealwatch

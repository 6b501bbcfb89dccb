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
    const double share = (t - times_[cursor]) / (times_[cursor + 1] - times_[cursor]);
    return input.values[cursor] + std::clamp(share, 0.0, 1.0) * (input.values[cursor + 1] - input.values[cursor]);
  }
  /// Slope of a channel where value() last looked; 0 where it is held.
  [[nodiscard]] double slope(std::size_t channel, std::size_t cursor) const {
    const InputChannel& input = channels_[channel];
    if (input.hold) return 0.0;
    return (input.values[cursor + 1] - input.values[cursor]) / (times_[cursor + 1] - times_[cursor]);
  }

 private:
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

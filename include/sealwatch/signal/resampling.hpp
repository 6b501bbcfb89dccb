// From sampling times as they came (jitter, absent rows) to a uniform grid.
//
// The grid starts at the first sample. Its interval is the mean interval with absent rows counted: a clock that follows
// the samples slowly says how many usual intervals lie between one sample and the next, at least one. Jitter of up to
// half an interval is no missing row.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace sealwatch::signal {

struct SamplingGrid {
  double begin_s = 0.0;
  double interval_s = 0.0;
  std::size_t count = 0;
  double jitter_std_s = 0.0;      ///< standard deviation of the recorded intervals about whole grid intervals
  std::size_t missing_count = 0;  ///< absent rows

  [[nodiscard]] double time_s(std::size_t index) const { return begin_s + interval_s * static_cast<double>(index); }
};

/// Grid for at least two strictly increasing times. Its count is no promise that it fits into memory: look before
/// resampling (core/test_limits.hpp).
[[nodiscard]] SamplingGrid find_grid(std::span<const double> times_s);

enum class Interpolation {
  cubic,  ///< through the four nearest samples; linear at ends and across gaps
  hold,   ///< the last value before
};

/// Values at the grid's times shifted by `shift_s` (the result at k is the signal at grid time k + shift_s). Where a
/// sample lies on the grid its value is taken as it is, so that a uniform recording passes unchanged. Not finite values
/// count as absent; outside of the recording the nearest value is repeated. All zero when no value is finite.
[[nodiscard]] std::vector<double> resample(std::span<const double> times_s, std::span<const double> values,
                                           const SamplingGrid& grid, Interpolation interpolation, double shift_s = 0.0);

}  // namespace sealwatch::signal

// Simple alterations of a simulated course that could make it the recorded one, fitted with coloured noise.
//
//   y(t) = b + g s(t_0 + (t - t_0)/c - tau) + e(t)       about a: y = a + b + g (s - a)
//
//   g gain, b offset, tau delay [s] (the recording is late), c clock rate (the recording's clock is fast for c > 1)
//   t_0 0, where both count from the same moment; the first time where 0 is far away
//
// Gain, delay and clock rate may be one for several channels, each with noise of its own. A global search on the raw
// difference for tau and c, then Gauss-Newton steps that maximise the likelihood of coloured_regression.hpp, which also
// gives the standard errors. Where the altered course ends before the recording does, the samples beyond do not count.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "sealwatch/trace/coloured_regression.hpp"
#include "sealwatch/trace/smooth_course.hpp"

namespace sealwatch::trace {

struct AlteredChannel {
  Eigen::VectorXd recorded;  ///< at the common times
  const Course* simulated = nullptr;
  double about = 0.0;           ///< a: 0, or the start value
  double least_variance = 0.0;  ///< by rounding
};

/// Which of the four are free; what is not is g = 1 (or `fixed_gain`), b = 0, tau = 0, c = 1.
struct Freedom {
  bool gain = false, offset = false, delay = false, clock = false;
  double fixed_gain = 1.0;
  [[nodiscard]] int count() const { return int{gain} + int{offset} + int{delay} + int{clock}; }
};

struct AlterationFit {
  double gain = 1.0, offset = 0.0, delay_s = 0.0, clock = 1.0;
  double gain_std = 0.0, offset_std = 0.0, delay_std_s = 0.0, clock_std = 0.0;
  double criterion = 0.0;                ///< sum of n log s^2, plus log n a free parameter
  std::vector<Eigen::VectorXd> altered;  ///< g s + b at the common times, one a channel
  Eigen::Index first = 0, count = 0;     ///< the samples that count
};

/// `time_s` uniform but for gaps. Nothing where the best delay or clock rate lies at the edge of what is searched.
[[nodiscard]] std::optional<AlterationFit> fit_alteration(const std::vector<double>& time_s,
                                                          const std::vector<AlteredChannel>& channels,
                                                          const Freedom& freedom, const Joints& joints = {});

}  // namespace sealwatch::trace

// Standard deviation of a channel's sample noise from the data alone, never from a model's residuals.
//
//   third difference  d_k = y_k+3 - 3 y_k+2 + 3 y_k+1 - y_k  of white noise has variance 20 sigma^2 and hides any
//   signal that is a parabola over four samples; its median absolute deviation is blind to the few samples where the
//   signal jumps:
//     sigma_hat = 1.4826 MAD(d) / sqrt(20)
//   where the signal is rounded coarsely, the root mean square of all but the largest tenth of |d| instead
//   a signal of few samples a period is no parabola over four of them: of white noise, differences of order 12 show the
//   same sigma, of such a signal far less of it, and where they show clearly less they are believed
//   where samples are unevenly spaced, their divided differences show it likewise: sum c_j y_k+j / |c|,
//   c_j = prod (i != j) 1 / (t_k+j - t_k+i), is 0 for a parabola and has variance sigma^2; where these show clearly less
//   they are believed
//   quantisation in steps of Delta adds Delta^2 / 12, the least that the noise can be.
//
// Noise that is correlated from sample to sample is underestimated: whoever uses the figure must test its residual for
// whiteness (estimation/residual_statistics.hpp).
#pragma once

#include <span>

#include "sealwatch/core/time_series.hpp"

namespace sealwatch::signal {

struct NoiseFloor {
  double standard_deviation = 0.0;  ///< in the channel's unit; 0 when the data cannot tell
  double quantisation_step = 0.0;   ///< in the channel's unit; 0 when none was seen
};

/// `time_s`: when the samples were taken; without it they count as equally spaced. What is no number is passed over;
/// fewer than 8 samples, or a constant channel, tell nothing.
[[nodiscard]] NoiseFloor estimate_noise_floor(std::span<const double> values, std::span<const double> time_s);
[[nodiscard]] NoiseFloor estimate_noise_floor(std::span<const double> values);

/// The standard deviation to believe of a channel: what the recording says of itself, else what its samples show, but at
/// least a tenth of the sensor's usual one (a counter that stands still for most of the test shows no noise; it has some
/// when it turns); where they show nothing, the usual one. 0 when nobody knows.
[[nodiscard]] double believed_noise_std(const Series& channel, double usual_noise_std, std::span<const double> time_s);
[[nodiscard]] double believed_noise_std(const Series& channel, double usual_noise_std);

}  // namespace sealwatch::signal

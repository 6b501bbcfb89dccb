// How well a fitted model does, so that models with more and fewer parameters compare.
//
//   criterion = misfit / phi + k max(ln(N / phi), 2) + 2 h + 2.2 r,   phi = max(1, misfit of the best model / N)
//
// k: free shared parameters; h: initial values of laws' hidden states; r: laws of the recording (input, clock), which are
// taken for a third as likely; N: whitened residuals; phi: how much the best model still misses, so that differences are
// not taken for more than they are. A model that misses grossly (misfit / N above 2) leaves not noise but a course,
// neighbouring samples of which say the same: its phi is multiplied by the residuals' correlation time in samples,
// tau = 1 + 2 sum rho_k up to the first rho_k <= 0. docs/mismatch.md gives the thresholds with their reasons.
#pragma once

#include "services/common/mismatch/fitted_model.hpp"

namespace sealwatch::mismatch {

/// Misfit over the noise's share of it above which what is left is not noise.
inline constexpr double kGross = 2.0;
/// The same, of what is no more than noise: the noise's own size is known to a tenth.
inline constexpr double kAtTheNoise = 1.1;
/// Criterion by which another law must improve: it then is e^6 times likelier.
inline constexpr double kWorthAnother = 12.0;
/// Criterion within which two explanations are not told apart.
inline constexpr double kCannotTell = 6.0;

/// Misfit over the noise's share of it, at least 1.
[[nodiscard]] double excess(const FittedModel& model);
[[nodiscard]] double criterion(const FittedModel& model, double dispersion);
/// Criterion of the first less that of the second, by the smaller dispersion of both.
[[nodiscard]] double criterion_behind(const FittedModel& model, const FittedModel& other);
/// phi of the model.
[[nodiscard]] double dispersion(const FittedModel& best);
/// Mean squared residual of the channel that is missed most, in noise variances: a difference in one of many must not
/// be lost in the mean of all.
[[nodiscard]] double largest_excess(const FittedModel& model);
/// Whether a fitted model and its recordings differ beyond the noise: by the scores of the laws, or grossly (mean
/// squared residual of a channel above twice the noise variance), whatever any law says to it.
[[nodiscard]] bool differs(double p_value, const FittedModel& model, double false_alarm_rate);

/// Correlation from sample to sample of what the model leaves, per channel, as a first-order autoregression.
[[nodiscard]] NoiseColour residual_colour(const FittedModel& model);

}  // namespace sealwatch::mismatch

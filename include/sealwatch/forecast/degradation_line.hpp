// A straight degradation line through a window of tests, and the distribution of the time at which it meets the
// threshold.
//
//   theta_i = theta_bar + b (y_i - y_bar) + e_i,   Var(e_i) = sigma^2        i = 1 .. n
//
//   theta  seal condition, leakage-derived index [1]
//   y      degradation time: t [months] or ln t [1]; a test's date is exact, all scatter is theta's
//   sigma^2   = max(residual variance with n - 2 degrees of freedom, s^2)     scatter of one estimate
//   s^2       = mean of PEM's own squared standard errors of theta            measuring error, which moves no seal
//   sigma_p^2 = sigma^2 - s^2                                                 the seal's own irregularity
//
// Time as a function of the estimate, t_hat(theta) = y_bar + (theta - theta_bar) / b, is the least-squares regression
// of y on theta with errors in the variable theta: ordinary least squares of y on theta gives the slope r^2 / b, too
// flat by the squared correlation r^2, because it takes theta for exact; dividing by the reliability ratio r^2 gives
// 1/b (W. A. Fuller, Measurement Error Models, 1987, section 1.2, with the error variance of theta taken from the
// scatter about the line).
//
// Distribution of the crossing time (inverse prediction, E. C. Fieller 1954): the end of life Y is before y when the
// line, known up to its estimation error and the seal's irregularity, is below theta_max at y,
//
//   P(Y <= y) = F_nu( (theta_max - theta_hat(y)) / se(y) ),   nu = n - 2
//   se(y)^2   = sigma_p^2 + sigma^2 / n + (sigma^2 / S_yy) (y - y_bar)^2 + kappa^2 b^2 (y - y_now)^2
//
//   F_nu   Student's t distribution;  S_yy = sum (y_i - y_bar)^2
//   kappa  standard deviation of the slope from now on relative to the window's slope (0: the line stays straight)
//
// Exact for normal scatter about a straight line with kappa = 0, and skewed to the late side as it must be.
#pragma once

#include <optional>
#include <span>

namespace sealwatch::forecast {

struct LinePoint {
  double y = 0.0;              ///< degradation time
  double condition = 0.0;      ///< theta_hat [1]
  double condition_std = 0.0;  ///< PEM's standard error [1]
};

struct DegradationLine {
  int tests = 0;
  double mean_y = 0.0;
  double mean_condition = 0.0;
  double slope = 0.0;                  ///< b [1 per unit of y]
  double sum_squares_y = 0.0;          ///< S_yy
  double scatter_variance = 0.0;       ///< sigma^2
  double irregularity_variance = 0.0;  ///< sigma_p^2
  double slope_drift = 0.0;            ///< kappa
  double now_y = 0.0;                  ///< y_now

  [[nodiscard]] int degrees_of_freedom() const { return tests - 2; }
  [[nodiscard]] double condition_at(double y) const { return mean_condition + slope * (y - mean_y); }
  [[nodiscard]] double slope_std() const;
  /// One-sided p-value of "the condition does not fall".
  [[nodiscard]] double no_fall_probability() const;
  /// se(y), with the change of slope counted from now.
  [[nodiscard]] double prediction_std(double y) const;
  /// P(Y <= y) for the time at which the condition falls to `threshold`.
  [[nodiscard]] double crossing_probability(double threshold, double y) const;
  /// The y before which the threshold is crossed with `probability`; none when the slope is too uncertain to say.
  [[nodiscard]] std::optional<double> crossing_quantile(double threshold, double probability) const;
};

/// None for fewer than three points or when all stand at one time.
[[nodiscard]] std::optional<DegradationLine> fit_degradation_line(std::span<const LinePoint> points,
                                                                  double slope_drift = 0.0, double now_y = 0.0);

}  // namespace sealwatch::forecast

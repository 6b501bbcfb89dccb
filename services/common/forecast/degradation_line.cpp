#include "sealwatch/forecast/degradation_line.hpp"

#include <algorithm>
#include <cmath>

#include "sealwatch/forecast/student_t.hpp"

namespace sealwatch::forecast {
namespace {

constexpr int kFittedNumbers = 2;  // mean and slope

// Scatter below this is the rounding of decimal files; it keeps se(y) > 0 for points that lie on a line exactly.
constexpr double kSmallestConditionStd = 1e-9;

}  // namespace

double DegradationLine::slope_std() const { return std::sqrt(scatter_variance / sum_squares_y); }

double DegradationLine::no_fall_probability() const {
  return student_t_probability(slope / slope_std(), degrees_of_freedom());
}

double DegradationLine::prediction_std(double y) const {
  const double mean_variance = irregularity_variance + scatter_variance / tests;
  const double from_mean = y - mean_y;
  const double from_now = y - now_y;
  const double variance = mean_variance + scatter_variance / sum_squares_y * from_mean * from_mean +
                          slope_drift * slope_drift * slope * slope * from_now * from_now;
  return std::sqrt(variance);
}

double DegradationLine::crossing_probability(double threshold, double y) const {
  return student_t_probability((threshold - condition_at(y)) / prediction_std(y), degrees_of_freedom());
}

// Solves threshold - theta_hat(y) = T_q se(y), a quadratic a Y^2 - 2 h Y + g = 0 in Y = y - y_bar, where
// h^2 - a g = T_q^2 root_squared (written out, because the difference cancels); the sign of T_q selects the root.
std::optional<double> DegradationLine::crossing_quantile(double threshold, double probability) const {
  const double T = student_t_quantile(probability, degrees_of_freedom());
  const double mean_variance = irregularity_variance + scatter_variance / tests;
  const double slope_variance = scatter_variance / sum_squares_y;
  const double drift_variance = slope_drift * slope_drift * slope * slope;
  const double fall = threshold - mean_condition;
  const double now = now_y - mean_y;
  const double a = slope * slope - T * T * (slope_variance + drift_variance);
  const double h = slope * fall - T * T * drift_variance * now;
  const double here = mean_variance + drift_variance * now * now;
  const double root_squared =
      slope * slope * here - 2.0 * slope * fall * drift_variance * now +
      (slope_variance + drift_variance) * fall * fall +
      T * T * (drift_variance * drift_variance * now * now - (slope_variance + drift_variance) * here);
  if (slope >= 0.0 || a <= 0.0) return std::nullopt;
  return mean_y + (h + T * std::sqrt(std::max(root_squared, 0.0))) / a;
}

std::optional<DegradationLine> fit_degradation_line(std::span<const LinePoint> points, double slope_drift,
                                                    double now_y) {
  DegradationLine line{.tests = static_cast<int>(points.size()), .slope_drift = slope_drift, .now_y = now_y};
  if (line.tests <= kFittedNumbers) return std::nullopt;
  double measuring_variance = 0.0;
  for (const LinePoint& point : points) {
    line.mean_y += point.y / line.tests;
    line.mean_condition += point.condition / line.tests;
    measuring_variance += point.condition_std * point.condition_std / line.tests;
  }
  double sum_products = 0.0;
  for (const LinePoint& point : points) {
    line.sum_squares_y += (point.y - line.mean_y) * (point.y - line.mean_y);
    sum_products += (point.y - line.mean_y) * (point.condition - line.mean_condition);
  }
  if (line.sum_squares_y <= 0.0) return std::nullopt;
  line.slope = sum_products / line.sum_squares_y;
  double residual_squares = 0.0;
  for (const LinePoint& point : points) residual_squares += std::pow(point.condition - line.condition_at(point.y), 2);
  const double floor = kSmallestConditionStd * kSmallestConditionStd;
  line.scatter_variance = std::max({residual_squares / line.degrees_of_freedom(), measuring_variance, floor});
  line.irregularity_variance = std::max(line.scatter_variance - measuring_variance, 0.0);
  return line;
}

}  // namespace sealwatch::forecast

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

double DegradationLine::crossing_probability(double threshold, double y) const {
  const double distance = y - mean_y;
  const double slope_variance = scatter_variance / sum_squares_y + slope_drift * slope_drift * slope * slope;
  const double variance = irregularity_variance + scatter_variance / tests + slope_variance * distance * distance;
  return student_t_probability((threshold - condition_at(y)) / std::sqrt(variance), degrees_of_freedom());
}

// Solves threshold - theta_hat(y) = T_q se(y), a quadratic in y - y_bar; the sign of T_q selects the root.
std::optional<double> DegradationLine::crossing_quantile(double threshold, double probability) const {
  const double T = student_t_quantile(probability, degrees_of_freedom());
  const double slope_variance = scatter_variance / sum_squares_y + slope_drift * slope_drift * slope * slope;
  const double mean_variance = irregularity_variance + scatter_variance / tests;
  const double distance = threshold - mean_condition;
  const double denominator = slope * slope - T * T * slope_variance;
  if (slope >= 0.0 || denominator <= 0.0) return std::nullopt;
  const double root = std::sqrt(mean_variance * denominator + slope_variance * distance * distance);
  return mean_y + (slope * distance + T * root) / denominator;
}

std::optional<DegradationLine> fit_degradation_line(std::span<const LinePoint> points, double slope_drift) {
  DegradationLine line{.tests = static_cast<int>(points.size()), .slope_drift = slope_drift};
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

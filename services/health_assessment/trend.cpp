#include "services/health_assessment/trend.hpp"

#include <cmath>

namespace sealwatch {
namespace {

constexpr std::size_t kFewestTests = 6;  // half a year of monthly tests
constexpr double kForgettingMonths = 12.0;

}  // namespace

std::optional<Trend> trend_of(const std::vector<GradeAt>& grades) {
  if (grades.size() < kFewestTests) return std::nullopt;
  const UtcTime now = grades.back().time;
  const auto years = [&](const GradeAt& g) { return months_between(now, g.time) / 12.0; };
  const auto weight = [&](const GradeAt& g) { return std::exp(years(g) * 12.0 / kForgettingMonths); };
  double sum = 0.0;
  double mean_time = 0.0;
  double mean_grade = 0.0;
  for (const GradeAt& g : grades) {
    sum += weight(g);
    mean_time += weight(g) * years(g);
    mean_grade += weight(g) * g.grade;
  }
  mean_time /= sum;
  mean_grade /= sum;
  double spread = 0.0;
  double covariance = 0.0;
  double squared_weights = 0.0;
  for (const GradeAt& g : grades) {
    const double t = years(g) - mean_time;
    spread += weight(g) * t * t;
    covariance += weight(g) * t * (g.grade - mean_grade);
    squared_weights += weight(g) * weight(g) * t * t;
  }
  if (!(spread > 0.0)) return std::nullopt;
  const double slope = covariance / spread;
  double residual = 0.0;
  for (const GradeAt& g : grades) residual += std::pow(g.grade - mean_grade - slope * (years(g) - mean_time), 2);
  const double variance = residual / static_cast<double>(grades.size() - 2);
  return Trend{slope, std::sqrt(variance * squared_weights) / spread};
}

}  // namespace sealwatch

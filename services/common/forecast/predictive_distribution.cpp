#include "sealwatch/forecast/predictive_distribution.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>

namespace sealwatch::forecast {
namespace {

constexpr double kRounding = 1e-9;  // sums of weights and of tabulated probabilities

using Point = PredictiveDistribution::Point;

double between(const Point& a, const Point& b, double months) {
  if (b.months <= a.months) return b.probability;
  return a.probability + (b.probability - a.probability) * (months - a.months) / (b.months - a.months);
}

/// Integral of (a linear function from u to v)^2 over `width`.
double integral_of_square(double u, double v, double width) { return width * (u * u + u * v + v * v) / 3.0; }

}  // namespace

Result<PredictiveDistribution> PredictiveDistribution::make(std::vector<Point> points) {
  if (points.empty()) return fail("a predictive distribution needs at least one point");
  for (std::size_t j = 0; j < points.size(); ++j) {
    const Point& here = points[j];
    if (!std::isfinite(here.months) || here.months < 0.0 || !(here.probability >= 0.0) ||
        here.probability > 1.0 + kRounding)
      return fail("months must be finite and not negative, probabilities within 0 and 1");
    if (j > 0 && (here.months < points[j - 1].months || here.probability < points[j - 1].probability - kRounding))
      return fail("months and probabilities must not fall");
  }
  for (Point& point : points) point.probability = std::min(point.probability, 1.0);
  return PredictiveDistribution(std::move(points));
}

double PredictiveDistribution::cdf(double months) const {
  if (months < points_.front().months) return 0.0;
  if (months >= points_.back().months) return 1.0;  // what is left counts as if it were there
  const auto after = std::upper_bound(points_.begin(), points_.end(), months,
                                      [](double value, const Point& point) { return value < point.months; });
  return between(*(after - 1), *after, months);
}

double PredictiveDistribution::quantile(double probability) const {
  const auto reached = std::lower_bound(points_.begin(), points_.end(), probability,
                                        [](const Point& point, double value) { return point.probability < value; });
  if (reached == points_.end()) return points_.back().months;
  if (reached == points_.begin()) return reached->months;
  const Point& before = *(reached - 1);
  const double rise = reached->probability - before.probability;
  if (rise <= 0.0) return reached->months;
  return before.months + (reached->months - before.months) * (probability - before.probability) / rise;
}

// E[T] = integral of 1 - F.
double PredictiveDistribution::mean() const {
  const double last = points_.back().months;
  return last - expected_months_failed_before(last);
}

double PredictiveDistribution::expected_months_failed_before(double months) const {
  double integral = 0.0;
  for (std::size_t j = 1; j < points_.size() && points_[j - 1].months < months; ++j) {
    const double to = std::min(points_[j].months, months);
    const double end = between(points_[j - 1], points_[j], to);
    integral += 0.5 * (points_[j - 1].probability + end) * (to - points_[j - 1].months);
  }
  return integral + std::max(months - points_.back().months, 0.0);
}

double PredictiveDistribution::crps(double observed_months) const {
  double sum =
      std::max(points_.front().months - observed_months, 0.0) + std::max(observed_months - points_.back().months, 0.0);
  for (std::size_t j = 1; j < points_.size(); ++j) {
    const Point& a = points_[j - 1];
    const Point& b = points_[j];
    const double y = std::clamp(observed_months, a.months, b.months);
    const double at_y = between(a, b, y);
    sum += integral_of_square(a.probability, at_y, y - a.months);
    sum += integral_of_square(1.0 - at_y, 1.0 - b.probability, b.months - y);
  }
  return sum;
}

std::array<double, kReportedLevels.size()> PredictiveDistribution::reported_quantiles() const {
  std::array<double, kReportedLevels.size()> quantiles{};
  std::transform(kReportedLevels.begin(), kReportedLevels.end(), quantiles.begin(),
                 [this](double level) { return quantile(level); });
  return quantiles;
}

Result<PredictiveDistribution> pool(std::span<const PredictiveDistribution> members, std::span<const double> weights) {
  if (members.empty() || members.size() != weights.size()) return fail("a pool needs one weight for each member");
  double sum = 0.0;
  for (const double weight : weights) {
    if (!(weight >= 0.0) || !std::isfinite(weight)) return fail("weights must be finite and not negative");
    sum += weight;
  }
  if (!(sum > 0.0)) return fail("at least one weight must be positive");

  std::vector<double> months;
  for (const PredictiveDistribution& member : members)
    for (const Point& point : member.points()) months.push_back(point.months);
  std::sort(months.begin(), months.end());
  months.erase(std::unique(months.begin(), months.end()), months.end());

  std::vector<Point> points(months.size());
  for (std::size_t j = 0; j < months.size(); ++j) points[j].months = months[j];
  for (std::size_t m = 0; m < members.size(); ++m) {
    const auto own = members[m].points();
    std::size_t next = 0;  // both run through the months in order: no search
    for (Point& point : points) {
      while (next < own.size() && own[next].months <= point.months) ++next;
      const double probability = next == 0            ? 0.0
                                 : next == own.size() ? 1.0
                                                      : between(own[next - 1], own[next], point.months);
      point.probability += weights[m] / sum * probability;
    }
  }
  return PredictiveDistribution::make(std::move(points));
}

}  // namespace sealwatch::forecast

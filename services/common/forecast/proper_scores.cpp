#include "sealwatch/forecast/proper_scores.hpp"

#include <algorithm>
#include <boost/math/distributions/beta.hpp>
#include <cmath>

#include "sealwatch/forecast/normal.hpp"

namespace sealwatch::forecast {
namespace {

constexpr double kPi = 3.14159265358979323846;

}  // namespace

double interval_score(double low, double high, double level, double observed) {
  return high - low + 2.0 / (1.0 - level) * (std::max(low - observed, 0.0) + std::max(observed - high, 0.0));
}

double normal_crps(double mean, double standard_deviation, double observed) {
  const double z = (observed - mean) / standard_deviation;
  return standard_deviation *
         (z * (2.0 * normal_probability(z) - 1.0) + 2.0 * normal_density(z) - 1.0 / std::sqrt(kPi));
}

std::vector<int> histogram(std::span<const double> probabilities, int bins) {
  std::vector<int> counts(static_cast<std::size_t>(std::max(bins, 1)), 0);
  for (const double p : probabilities) {
    const auto bin = static_cast<std::size_t>(std::clamp(p, 0.0, 1.0) * static_cast<double>(counts.size()));
    ++counts[std::min(bin, counts.size() - 1)];
  }
  return counts;
}

Result<Interval> clopper_pearson(int successes, int trials, double level) {
  if (trials < 1 || successes < 0 || successes > trials)
    return fail("a share needs at least one trial, and not more successes than trials");
  if (!(level > 0.0 && level < 1.0)) return fail("a level must be within 0 and 1");
  const double tail = 0.5 * (1.0 - level);
  Interval interval{0.0, 1.0};
  if (successes > 0)
    interval.low =
        boost::math::quantile(boost::math::beta_distribution<double>(successes, trials - successes + 1.0), tail);
  if (successes < trials)
    interval.high =
        boost::math::quantile(boost::math::beta_distribution<double>(successes + 1.0, trials - successes), 1.0 - tail);
  return interval;
}

Result<ClusteredMean> clustered_mean(std::span<const Cluster> lives) {
  ClusteredMean result;
  double sum = 0.0;
  for (const Cluster& life : lives) {
    if (life.count <= 0) continue;
    ++result.lives;
    result.values += life.count;
    sum += life.sum;
  }
  if (result.lives < 2) return fail("a standard error needs at least two lives");
  result.mean = sum / result.values;
  double squares = 0.0;
  for (const Cluster& life : lives)
    if (life.count > 0) squares += std::pow(life.sum - result.mean * life.count, 2);
  result.standard_error = std::sqrt(squares * result.lives / (result.lives - 1.0)) / result.values;
  return result;
}

}  // namespace sealwatch::forecast

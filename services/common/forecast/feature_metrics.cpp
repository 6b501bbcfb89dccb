// Metrics of the estimates themselves (Coble and Hines).
#include <algorithm>
#include <cmath>
#include <numeric>

#include "sealwatch/forecast/prognostic_metrics.hpp"

namespace sealwatch::forecast {
namespace {

constexpr std::size_t kSharesOfLife = 101;  // every percent of a life

Status check_features(std::span<const Feature> lives, std::size_t fewest) {
  if (lives.size() < fewest) return fail("at least " + std::to_string(fewest) + " lives are needed");
  for (const Feature& life : lives)
    if (life.size() < 2 || !std::all_of(life.begin(), life.end(), [](double value) { return std::isfinite(value); }))
      return fail("each life needs at least two finite values");
  return {};
}

/// The feature at kSharesOfLife equal shares of its life.
Feature stretched(const Feature& life) {
  Feature result;
  for (std::size_t k = 0; k < kSharesOfLife; ++k) {
    const double place = static_cast<double>(k * (life.size() - 1)) / static_cast<double>(kSharesOfLife - 1);
    const std::size_t below = std::min(static_cast<std::size_t>(place), life.size() - 2);
    result.push_back(life[below] + (place - static_cast<double>(below)) * (life[below + 1] - life[below]));
  }
  return result;
}

double mean(const Feature& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// 0 for a feature that does not move: it has no trend to share.
double correlation(const Feature& a, const Feature& b) {
  const double mean_a = mean(a);
  const double mean_b = mean(b);
  double ab = 0.0;
  double aa = 0.0;
  double bb = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    ab += (a[k] - mean_a) * (b[k] - mean_b);
    aa += (a[k] - mean_a) * (a[k] - mean_a);
    bb += (b[k] - mean_b) * (b[k] - mean_b);
  }
  return aa > 0.0 && bb > 0.0 ? ab / std::sqrt(aa * bb) : 0.0;
}

}  // namespace

Result<double> monotonicity(std::span<const Feature> lives) {
  if (const Status valid = check_features(lives, 1); !valid) return fail(valid.error());
  double sum = 0.0;
  for (const Feature& life : lives) {
    int rises = 0;
    int falls = 0;
    for (std::size_t i = 1; i < life.size(); ++i) {
      rises += life[i] > life[i - 1];
      falls += life[i] < life[i - 1];
    }
    sum += std::abs(rises - falls) / static_cast<double>(life.size() - 1);
  }
  return sum / static_cast<double>(lives.size());
}

Result<double> trendability(std::span<const Feature> lives) {
  if (const Status valid = check_features(lives, 2); !valid) return fail(valid.error());
  std::vector<Feature> same_length;
  for (const Feature& life : lives) same_length.push_back(stretched(life));
  double smallest = 1.0;
  for (std::size_t i = 0; i < same_length.size(); ++i)
    for (std::size_t j = i + 1; j < same_length.size(); ++j)
      smallest = std::min(smallest, std::abs(correlation(same_length[i], same_length[j])));
  return smallest;
}

Result<double> prognosability(std::span<const Feature> lives) {
  if (const Status valid = check_features(lives, 2); !valid) return fail(valid.error());
  Feature last;
  Feature way;
  for (const Feature& life : lives) {
    last.push_back(life.back());
    way.push_back(std::abs(life.back() - life.front()));
  }
  if (mean(way) <= 0.0) return fail("no life moves from its first value");
  double squares = 0.0;
  for (const double value : last) squares += std::pow(value - mean(last), 2);
  return std::exp(-std::sqrt(squares / static_cast<double>(last.size() - 1)) / mean(way));
}

}  // namespace sealwatch::forecast

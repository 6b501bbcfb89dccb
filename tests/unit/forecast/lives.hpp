// Synthetic histories for the forecast tests.
#pragma once

#include <random>
#include <vector>

#include "sealwatch/forecast/condition_history.hpp"

namespace sealwatch::forecast::test {

inline const UtcTime kInstalled = parse_utc("2010-01-01").value();

inline UtcTime month(double months) { return add_months(kInstalled, months); }

/// theta = 1 - fall_per_month t at t = 1 .. tests months, without noise.
inline std::vector<ConditionSample> straight_life(int tests, double fall_per_month, double condition_std) {
  std::vector<ConditionSample> life;
  for (int n = 1; n <= tests; ++n) life.push_back({month(n), 1.0 - fall_per_month * n, condition_std});
  return life;
}

inline std::vector<ConditionSample> with_noise(std::vector<ConditionSample> life, double noise_std,
                                               std::mt19937_64& random) {
  std::normal_distribution<double> noise(0.0, noise_std);
  for (ConditionSample& sample : life) sample.condition += noise(random);
  return life;
}

}  // namespace sealwatch::forecast::test

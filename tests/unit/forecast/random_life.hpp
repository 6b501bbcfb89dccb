// Random lives of the reference recursion as a forecaster sees them, with what may go wrong on the way.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "sealwatch/forecast/condition_history.hpp"
#include "sealwatch/forecast/degradation.hpp"
#include "services/verification/lives/oracle.hpp"
#include "tests/unit/forecast/lives.hpp"

namespace sealwatch::forecast::test {

struct MonthOfLife {
  TrueState state;
  std::optional<ConditionSample> sample;  ///< none: no usable test in this month
  bool foreseeable = true;                ///< false until half a year after a change, and before a replacement
};

struct RandomLife {
  std::vector<MonthOfLife> months;
  double end_months = 0.0;  ///< when theta passes the threshold, linear between months
  double condition_std = 0.0;
  bool installation_known = true;
};

/// Scenarios:
///   reference      as it is                               outliers  one test in twenty is off by 0.02 to 0.10
///   missing        a month in four has no usable test     rate      from month 72 on it ages 1.5 times as fast
///   level          from month 72 on estimates are 0.02 low          errors    true scatter is three times what is told
///   late           the first test comes at month 60, the installation is not known
///   mild, double, triple, slower  as `rate`, but 1.25, 2, 3 and 0.67 times
///   regular        as `rate`, but the months' irregularity stays what it was
///   unlike         of another population, that ages twice as fast     line  theta falls straight
///   starting       of the constants that the reference model starts from, before its calibration
///   replaced       at month 48 another seal, unannounced  unknown   estimates come without a standard error
/// How many times as fast it ages from month 72 on; 1 where nothing changes.
inline double changed_rate(const std::string& scenario) {
  if (scenario == "rate" || scenario == "regular") return 1.5;
  if (scenario == "mild") return 1.25;
  if (scenario == "double") return 2.0;
  if (scenario == "triple") return 3.0;
  return scenario == "slower" ? 0.67 : 1.0;
}

inline RandomLife random_life(std::uint64_t seed, const std::string& scenario, double fixed_std, double threshold) {
  constexpr double kChange = 72.0;
  constexpr int kLongest = 480;
  std::mt19937_64 random(seed * 7919 + 13);
  std::normal_distribution<double> normal(0.0, 1.0);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  RandomLife life;
  life.condition_std = fixed_std > 0.0 ? fixed_std : 0.003 * std::pow(0.01 / 0.003, uniform(random));
  life.installation_known = scenario != "late";
  DegradationSetting setting;
  if (scenario == "unlike") setting = {.initial_gamma = {0.06, 0.10}, .steepening_limit = {0.0035, 0.005}};
  if (scenario == "starting") setting = {.steepening_limit = {0.0016, 0.005}, .irregularity = {-0.05, 0.10}};
  Degradation seal(seed, setting);
  const double straight_fall = 0.002 + 0.004 * uniform(random);
  double offset = 0.0;  // of the calendar, where an earlier seal was replaced
  if (scenario == "replaced") {
    Degradation first(seed + 1000000);
    for (offset = 1.0; offset <= 48.0 && first.advance() > threshold; offset += 1.0)
      life.months.push_back(
          {{.month = offset - 1e6},  // of another life: not scored
           ConditionSample{month(offset), first.condition() + life.condition_std * normal(random), life.condition_std},
           false});
  }
  const double faster = changed_rate(scenario);
  double extra_fall = 0.0;
  double before = 1.0;
  for (int n = 1; n <= kLongest; ++n) {
    const double last = seal.condition();
    seal.advance();
    if (n > kChange) {
      const double mean_irregularity = 0.5 * (setting.irregularity.min + setting.irregularity.max);
      const double regular = (seal.gamma() + mean_irregularity) * std::log((n + setting.n_0) / (n - 1 + setting.n_0));
      extra_fall += (faster - 1.0) * (scenario == "regular" ? regular : last - seal.condition());
    }
    const double condition = scenario == "line" ? 1.0 - straight_fall * n : seal.condition() - extra_fall;
    MonthOfLife now{.state = {.month = static_cast<double>(n),
                              .condition = condition,
                              .gamma = seal.gamma() * (n > kChange ? faster : 1.0),
                              .steepening_limit = seal.steepening_limit() * (n > kChange ? faster : 1.0)},
                    .sample = std::nullopt};
    if (faster != 1.0 || scenario == "level") now.foreseeable = n > kChange + 6.0;
    double estimate = condition + life.condition_std * normal(random);
    if (scenario == "errors") estimate += 2.83 * life.condition_std * normal(random);
    if (scenario == "outliers" && uniform(random) < 0.05)
      estimate += (uniform(random) < 0.5 ? -1.0 : 1.0) * (0.02 + 0.08 * uniform(random));
    if (scenario == "level" && n > kChange) estimate -= 0.02;
    const bool missing = (scenario == "missing" && uniform(random) < 0.25) || (scenario == "late" && n < 60);
    const double told = scenario == "unknown" ? 0.0 : life.condition_std;
    if (!missing) now.sample = ConditionSample{month(offset + n), estimate, told};
    life.months.push_back(now);
    // A level shift moves what is measured past the threshold, and with it the end that can be forecast.
    const double seen = condition - (scenario == "level" && n > kChange ? 0.02 : 0.0);
    if (seen <= threshold) {
      life.end_months = n - (threshold - seen) / std::max(before - seen, 1e-9);
      break;
    }
    before = seen;
  }
  return life;
}

}  // namespace sealwatch::forecast::test

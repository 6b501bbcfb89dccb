// What one forecaster says of the remaining useful life. The field lists let a topic carry it as it is.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sealwatch/core/fields.hpp"

namespace sealwatch {

SEALWATCH_ENUM(ForecastState, ok, no_significant_trend, insufficient_history, past_threshold)

/// Probability of failure before a date.
struct FailureProbability {
  std::int64_t before_ns = 0;
  std::string label;  ///< "campaign 2031"
  double probability = 0.0;
  SEALWATCH_FIELDS(FailureProbability, before_ns, label, probability)
  friend bool operator==(const FailureProbability&, const FailureProbability&) = default;
};

/// One forecaster's answer. Numbers are valid only in state ok (and past_threshold: all zero).
struct Forecast {
  std::string method;  ///< "ols", "ols_log_time", ...
  std::int32_t window_months = 0;
  ForecastState state = ForecastState::insufficient_history;
  std::string explanation;  ///< "12 of 24 tests so far"
  std::int32_t tests_used = 0;
  double rul_months = 0.0;  ///< t_RUL, the point forecast
  double rul_p10_months = 0.0;
  double rul_p50_months = 0.0;
  double rul_p90_months = 0.0;
  double interval_95_low_months = 0.0;
  double interval_95_high_months = 0.0;
  std::int64_t end_of_life_ns = 0;
  std::vector<FailureProbability> failure_probability;
  SEALWATCH_FIELDS(Forecast, method, window_months, state, explanation, tests_used, rul_months, rul_p10_months,
                   rul_p50_months, rul_p90_months, interval_95_low_months, interval_95_high_months, end_of_life_ns,
                   failure_probability)
  friend bool operator==(const Forecast&, const Forecast&) = default;
};

}  // namespace sealwatch

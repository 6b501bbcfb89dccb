// What a verification found: docs/reference/metrics.md over all lives, with 95 % intervals. A pure function of
// the records, taken in the order of the lives' numbers: shards and threads change no digit.
//
// Shares of lives have exact intervals (Clopper, Pearson); means over lives or over months have their standard error
// from the lives, one cluster each (proper_scores.hpp). Lives that outlast the months of service are counted and left
// out: what "until failure" means is not seen in them.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "sealwatch/forecast/prognostic_metrics.hpp"
#include "sealwatch/forecast/proper_scores.hpp"
#include "services/verification/lives/life_record.hpp"

namespace sealwatch::verification {

/// Months before failure at which forecasts are looked at one by one.
inline constexpr std::array<double, 4> kHorizons_months{36.0, 24.0, 12.0, 6.0};
inline constexpr int kPitBins = 20;
inline constexpr int kCurveMonths = 120;
inline constexpr double kHorizonAlpha = 0.05;      ///< prognostic horizon: |e| <= alpha of the life
inline constexpr double kAlphaLambdaLambda = 0.5;  ///< judged at half of the way, with kAlphaLambdaAlpha
inline constexpr double kAlphaLambdaBeta = 0.5;    ///< probability mass that counts as accurate

struct Share {
  int of = 0;
  int count = 0;
  forecast::Interval interval;  ///< 95 %
  [[nodiscard]] double value() const { return of > 0 ? static_cast<double>(count) / of : 0.0; }
};

/// A mean with its 95 % interval; none: no life has a value.
struct Mean {
  bool known = false;
  double value = 0.0;
  double standard_error = 0.0;
  int lives = 0;
};

/// 5, 25, 50, 75, 95 % of values.
struct Quantiles {
  int values = 0;
  std::array<double, 5> at{};
};

/// Forecasts at one of kHorizons_months before failure, one a life.
struct HorizonSummary {
  double months = 0.0;
  Share answered;                 ///< lives with a number then
  std::array<Share, 3> coverage;  ///< of the central 50, 80 and 95 % intervals
  Mean absolute_error, crps, width_95, interval_score_80, interval_score_95;
  Quantiles error;  ///< forecast minus truth
};

struct WorstLife {
  std::uint32_t life = 0;
  double error_months = 0.0;  ///< mean |error| of the last three years
};

struct MethodSummary {
  std::string label;
  Share converged, reliable, timely, timely_of_converged;
  Mean antecedence, error, error_since_converged;                        ///< of the lives that are reliable (converged)
  Mean final_error, last_year_error, last_year_width, error_all_months;  ///< absolute errors
  Mean false_positive, false_negative;  ///< share of the months in which an alarm was not due (was due)
  Mean before_p10;                      ///< share of the forecasts whose P10 the failure came before
  Mean oracle_ratio;                    ///< absolute error of all months, over the oracle's in the same months
  Quantiles final_error_box, antecedence_box;
  std::vector<HorizonSummary> horizons;
  std::array<int, kPitBins> pit{};        ///< at all horizons
  std::vector<double> reliable_by_month;  ///< share of lives that are reliable from k months before failure on
  Share horizon_stable, alpha_lambda;
  Share alpha_lambda_by_mass;  ///< lives whose mass then is at least kAlphaLambdaBeta
  Mean alpha_lambda_mass;      ///< the mass itself
  Mean horizon_first_months, horizon_stable_months, cumulative_relative_accuracy, convergence_distance,
      asymmetric_score;
  std::vector<WorstLife> worst;
};

struct Summary {
  int lives = 0;
  int censored = 0;
  std::int64_t tests = 0;
  std::int64_t unusable_tests = 0;
  Quantiles lifetime_years;
  Share fails_in_8_to_20_years;
  Mean estimate_chi_square;                                             ///< ((estimate - theta) / its standard error)^2
  Share estimate_within_95;                                             ///< of a sample of tests, one a life
  Mean estimate_std;                                                    ///< of theta
  double monotonicity = 0.0, trendability = 0.0, prognosability = 0.0;  ///< of the estimate
  std::vector<MethodSummary> methods;                                   ///< the oracle last
};

/// `read(k)` gives life k of `lives`. An Error when a record cannot be read or has not the methods of `labels`.
[[nodiscard]] Result<Summary> summarise(std::uint32_t lives, const std::vector<std::string>& labels,
                                        const std::function<Result<LifeRecord>(std::uint32_t)>& read);

/// One life's answers as the metrics take them.
[[nodiscard]] std::vector<forecast::ScoredMonth> scored_months(const LifeRecord& record, std::size_t method);

}  // namespace sealwatch::verification

// How good the forecasts of one life were, once its end is known. Formulas with sources: docs/reference/metrics.md.
//
//   r*(t)  true remaining life at month t [months];  r(t) forecast;  e(t) = r(t) - r*(t), positive: too late
//
// A month without a number is a month outside every tolerance, never one passed over: a forecaster that falls silent is
// not reliable. "Past the threshold" is the number 0.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "sealwatch/core/result.hpp"
#include "sealwatch/forecast/forecast.hpp"
#include "sealwatch/forecast/predictive_distribution.hpp"

namespace sealwatch::forecast {

struct ScoredMonth {
  double time_months = 0.0;          ///< t, since installation
  double true_rul_months = 0.0;      ///< r*(t) > 0
  std::optional<double> rul_months;  ///< r(t); none: no number was given
  /// Width of the 95 % interval; none as above.
  std::optional<double> width_95_months = {};
  [[nodiscard]] double error_months() const { return rul_months.value_or(0.0) - true_rul_months; }
};

/// How metrics read a forecast: its number in state ok, 0 in state past_threshold, else none.
[[nodiscard]] ScoredMonth scored_month(const Forecast& forecast, double time_months, double true_rul_months);

/// Months in increasing time, all before the end of life and consistent with one end of life.
[[nodiscard]] Status check_months(std::span<const ScoredMonth> months);

/// |e(t)| <= max(floor_months, share r*(t)).
struct Tolerance {
  double floor_months = 3.0;
  double share = 0.25;
  [[nodiscard]] bool holds(const ScoredMonth& month) const;
};

// ---- docs/reference/metrics.md, "The published experiment"
// -------------------------------------------------------------------------------------------------

struct LifeCriteria {
  Tolerance reliable{3.0, 0.25};
  Tolerance converged{6.0, 0.50};
  double booking_months = 12.0;  ///< a vessel's lead: what "timely" and the alarms mean
};

/// The first month after which, until failure, the tolerance holds.
struct StableSpan {
  double lead_months = 0.0;        ///< true remaining life at that month: the antecedence
  double mean_error_months = 0.0;  ///< mean |e| from then on
};
[[nodiscard]] std::optional<StableSpan> stable_span(std::span<const ScoredMonth> months, const Tolerance& tolerance);

/// An alarm is a forecast r(t) <= booking time; it is due when r*(t) <= booking time.
struct AlarmCounts {
  int due = 0;             ///< months in which it is due
  int not_due = 0;         ///< other months
  int false_negative = 0;  ///< due, but not given (a month without a number gives none)
  int false_positive = 0;  ///< given, not due
};
[[nodiscard]] AlarmCounts count_alarms(std::span<const ScoredMonth> months, double booking_months);

struct LifeVerdict {
  std::optional<StableSpan> reliable;
  std::optional<StableSpan> converged;
  bool timely = false;  ///< reliable at least booking_months before failure
  AlarmCounts alarms;
  std::optional<double> final_error_months = {};      ///< e at the last month that has a number
  std::optional<double> last_year_error_months = {};  ///< mean |e| over r* <= 12
  std::optional<double> last_year_width_months = {};  ///< mean 95 % width over r* <= 12
};
[[nodiscard]] LifeVerdict judge_life(std::span<const ScoredMonth> months, const LifeCriteria& criteria = {});

// ---- A. Saxena et al., Metrics for Offline Evaluation of Prognostic Performance, 2010
// --------------------------------

struct PrognosticHorizon {
  std::optional<double> first;   ///< r* at the first month with |e| <= alpha EoL
  std::optional<double> stable;  ///< r* at the first month from which on it stays so until the end
};
[[nodiscard]] PrognosticHorizon prognostic_horizon(std::span<const ScoredMonth> months, double alpha);

/// The month in which alpha-lambda metrics are judged: the last one not after t_lambda = t_P + lambda (EoL - t_P), t_P
/// the first month with a number. None when no number was ever given.
[[nodiscard]] std::optional<std::size_t> alpha_lambda_month(std::span<const ScoredMonth> months, double lambda);

/// |e| <= alpha r* in that month.
[[nodiscard]] std::optional<bool> alpha_lambda_accuracy(std::span<const ScoredMonth> months, double alpha,
                                                        double lambda);

/// A month with the whole distribution behind its number. A number without one (past the threshold: 0) is certain.
struct PredictedMonth {
  ScoredMonth scored;
  std::optional<PredictiveDistribution> distribution = {};
};

/// pi = F((1 + alpha) r*) - F((1 - alpha) r*): probability that the forecast gives to the tolerated interval; 0 in a
/// month without a number.
[[nodiscard]] double probability_within(const PredictedMonth& month, double alpha);

/// The same metric for distributions: pi >= beta in the month in which alpha_lambda_accuracy is judged.
struct AlphaLambdaMass {
  double probability = 0.0;  ///< pi
  bool accurate = false;
};
[[nodiscard]] std::optional<AlphaLambdaMass> alpha_lambda_mass(std::span<const PredictedMonth> months, double alpha,
                                                               double lambda, double beta = 0.5);

/// RA = 1 - |e| / r*, of the remaining life, not of the date: 1 is perfect, negative is worse than saying 0.
[[nodiscard]] std::optional<double> relative_accuracy(const ScoredMonth& month);
/// Mean of RA over the months with a number.
[[nodiscard]] std::optional<double> cumulative_relative_accuracy(std::span<const ScoredMonth> months);

/// Distance from (t_P, 0) to the centroid of the area under |e(t)|: small when errors are small and fall early. None
/// with fewer than two numbers, 0 without any error.
[[nodiscard]] std::optional<double> convergence_distance(std::span<const ScoredMonth> months);

/// Mean of exp(-e/13) - 1 for early and exp(e/10) - 1 for late forecasts (PHM 2008 challenge): late costs more.
[[nodiscard]] std::optional<double> asymmetric_score(std::span<const ScoredMonth> months, double early_months = 13.0,
                                                     double late_months = 10.0);

// ---- J. Coble, J. W. Hines, Identifying optimal prognostic parameters, 2009: of the estimates themselves
// -------------

/// The estimate over a life, from installation to failure, in the order of time.
using Feature = std::vector<double>;

/// Mean over lives of |rises - falls| / (steps): 1 for strictly monotone.
[[nodiscard]] Result<double> monotonicity(std::span<const Feature> lives);
/// Smallest |correlation| between two lives, each stretched to the same share of its life.
[[nodiscard]] Result<double> trendability(std::span<const Feature> lives);
/// exp(-std of last values / mean |last - first|): 1 when all fail at one value.
[[nodiscard]] Result<double> prognosability(std::span<const Feature> lives);

}  // namespace sealwatch::forecast

#include "sealwatch/forecast/prognostic_metrics.hpp"

#include <algorithm>
#include <cmath>

namespace sealwatch::forecast {
namespace {

constexpr double kLastYear_months = 12.0;
constexpr double kSameEnd_months = 1e-3;  // rounding of dates

double end_of_life(std::span<const ScoredMonth> months) {
  return months.front().time_months + months.front().true_rul_months;
}

/// Index of the first month from which on `holds` is true until the end; the number of months when it never is.
template <class Rule>
std::size_t first_of_stable_span(std::span<const ScoredMonth> months, const Rule& holds) {
  std::size_t first = months.size();
  while (first > 0 && holds(months[first - 1])) --first;
  return first;
}

std::vector<ScoredMonth> with_number(std::span<const ScoredMonth> months) {
  std::vector<ScoredMonth> given;
  std::copy_if(months.begin(), months.end(), std::back_inserter(given),
               [](const ScoredMonth& month) { return month.rul_months.has_value(); });
  return given;
}

/// Index of the last month not after t_lambda = t_P + lambda (EoL - t_P); none when no number was ever given.
template <class Month, class Scored>
std::optional<std::size_t> judged_month(std::span<const Month> months, double lambda, const Scored& scored) {
  const auto first =
      std::find_if(months.begin(), months.end(), [&](const Month& m) { return scored(m).rul_months.has_value(); });
  if (first == months.end()) return std::nullopt;
  const double t_lambda = scored(*first).time_months + lambda * scored(*first).true_rul_months;
  auto judged = static_cast<std::size_t>(first - months.begin());
  while (judged + 1 < months.size() && scored(months[judged + 1]).time_months <= t_lambda) ++judged;
  return judged;
}

}  // namespace

ScoredMonth scored_month(const Forecast& forecast, double time_months, double true_rul_months) {
  ScoredMonth month{.time_months = time_months, .true_rul_months = true_rul_months, .rul_months = std::nullopt};
  if (forecast.state == ForecastState::past_threshold) month.rul_months = 0.0;
  if (forecast.state == ForecastState::ok) {
    month.rul_months = forecast.rul_months;
    month.width_95_months = forecast.interval_95_high_months - forecast.interval_95_low_months;
  }
  return month;
}

Status check_months(std::span<const ScoredMonth> months) {
  for (std::size_t i = 0; i < months.size(); ++i) {
    if (!std::isfinite(months[i].time_months) || !(months[i].true_rul_months > 0.0) ||
        !std::isfinite(months[i].true_rul_months) || !std::isfinite(months[i].rul_months.value_or(0.0)))
      return fail("times and remaining lives must be finite, and the end of life must come after every month");
    if (i > 0 && months[i].time_months <= months[i - 1].time_months)
      return fail("months must increase", "sort them and keep one per test");
    const double end = months[i].time_months + months[i].true_rul_months;
    if (std::abs(end - end_of_life(months)) > kSameEnd_months) return fail("all months of a life must have one end");
  }
  return {};
}

bool Tolerance::holds(const ScoredMonth& month) const {
  return month.rul_months && std::abs(month.error_months()) <= std::max(floor_months, share * month.true_rul_months);
}

std::optional<StableSpan> stable_span(std::span<const ScoredMonth> months, const Tolerance& tolerance) {
  const std::size_t first = first_of_stable_span(months, [&](const ScoredMonth& m) { return tolerance.holds(m); });
  if (first == months.size()) return std::nullopt;
  StableSpan span{.lead_months = months[first].true_rul_months};
  for (std::size_t i = first; i < months.size(); ++i)
    span.mean_error_months += std::abs(months[i].error_months()) / static_cast<double>(months.size() - first);
  return span;
}

AlarmCounts count_alarms(std::span<const ScoredMonth> months, double booking_months) {
  AlarmCounts counts;
  for (const ScoredMonth& month : months) {
    const bool given = month.rul_months && *month.rul_months <= booking_months;
    const bool due = month.true_rul_months <= booking_months;
    counts.due += due;
    counts.not_due += !due;
    counts.false_negative += due && !given;
    counts.false_positive += !due && given;
  }
  return counts;
}

LifeVerdict judge_life(std::span<const ScoredMonth> months, const LifeCriteria& criteria) {
  LifeVerdict verdict;
  verdict.reliable = stable_span(months, criteria.reliable);
  verdict.converged = stable_span(months, criteria.converged);
  verdict.timely = verdict.reliable && verdict.reliable->lead_months >= criteria.booking_months;
  verdict.alarms = count_alarms(months, criteria.booking_months);
  int numbers = 0;
  int widths = 0;
  double errors = 0.0;
  double width = 0.0;
  for (const ScoredMonth& month : months) {
    if (!month.rul_months) continue;
    verdict.final_error_months = month.error_months();
    if (month.true_rul_months > kLastYear_months) continue;
    ++numbers;
    errors += std::abs(month.error_months());
    if (!month.width_95_months) continue;
    ++widths;
    width += *month.width_95_months;
  }
  if (numbers > 0) verdict.last_year_error_months = errors / numbers;
  if (widths > 0) verdict.last_year_width_months = width / widths;
  return verdict;
}

PrognosticHorizon prognostic_horizon(std::span<const ScoredMonth> months, double alpha) {
  PrognosticHorizon horizon;
  if (months.empty()) return horizon;
  const double limit = alpha * end_of_life(months);
  const auto holds = [&](const ScoredMonth& m) { return m.rul_months && std::abs(m.error_months()) <= limit; };
  if (const auto first = std::find_if(months.begin(), months.end(), holds); first != months.end())
    horizon.first = first->true_rul_months;
  if (const std::size_t stable = first_of_stable_span(months, holds); stable < months.size())
    horizon.stable = months[stable].true_rul_months;
  return horizon;
}

std::optional<std::size_t> alpha_lambda_month(std::span<const ScoredMonth> months, double lambda) {
  return judged_month(
      months, lambda, [](const ScoredMonth& month) -> const auto& { return month; });
}

std::optional<bool> alpha_lambda_accuracy(std::span<const ScoredMonth> months, double alpha, double lambda) {
  const auto judged = alpha_lambda_month(months, lambda);
  if (!judged) return std::nullopt;
  return Tolerance{.floor_months = 0.0, .share = alpha}.holds(months[*judged]);
}

double probability_within(const PredictedMonth& month, double alpha) {
  const ScoredMonth& scored = month.scored;
  if (!scored.rul_months) return 0.0;
  if (!month.distribution) return Tolerance{.floor_months = 0.0, .share = alpha}.holds(scored) ? 1.0 : 0.0;
  const double r = scored.true_rul_months;
  return month.distribution->cdf((1.0 + alpha) * r) - month.distribution->cdf((1.0 - alpha) * r);
}

std::optional<AlphaLambdaMass> alpha_lambda_mass(std::span<const PredictedMonth> months, double alpha, double lambda,
                                                 double beta) {
  const auto judged = judged_month(
      months, lambda, [](const PredictedMonth& month) -> const auto& { return month.scored; });
  if (!judged) return std::nullopt;
  const double probability = probability_within(months[*judged], alpha);
  return AlphaLambdaMass{.probability = probability, .accurate = probability >= beta};
}

std::optional<double> relative_accuracy(const ScoredMonth& month) {
  if (!month.rul_months) return std::nullopt;
  return 1.0 - std::abs(month.error_months()) / month.true_rul_months;
}

std::optional<double> cumulative_relative_accuracy(std::span<const ScoredMonth> months) {
  double sum = 0.0;
  int numbers = 0;
  for (const ScoredMonth& month : months)
    if (const auto accuracy = relative_accuracy(month)) {
      sum += *accuracy;
      ++numbers;
    }
  if (numbers == 0) return std::nullopt;
  return sum / numbers;
}

// Centroid of the area under the steps M_i = |e(t_i)| on [t_i, t_{i+1}] (Saxena et al. 2010, eq. 12):
//   x = 1/2 sum (t_{i+1}^2 - t_i^2) M_i / sum (t_{i+1} - t_i) M_i,   y = 1/2 sum (t_{i+1} - t_i) M_i^2 / the same
std::optional<double> convergence_distance(std::span<const ScoredMonth> months) {
  const std::vector<ScoredMonth> given = with_number(months);
  if (given.size() < 2) return std::nullopt;
  const double t_P = given.front().time_months;
  double area = 0.0;
  double moment_time = 0.0;
  double moment_error = 0.0;
  for (std::size_t i = 0; i + 1 < given.size(); ++i) {
    const double from = given[i].time_months - t_P;  // counted from t_P: nothing cancels, and the distance is its own
    const double to = given[i + 1].time_months - t_P;
    const double M = std::abs(given[i].error_months());
    area += (to - from) * M;
    moment_time += 0.5 * (to * to - from * from) * M;
    moment_error += 0.5 * (to - from) * M * M;
  }
  if (area <= 0.0) return 0.0;
  return std::hypot(moment_time / area, moment_error / area);
}

std::optional<double> asymmetric_score(std::span<const ScoredMonth> months, double early_months, double late_months) {
  const std::vector<ScoredMonth> given = with_number(months);
  if (given.empty()) return std::nullopt;
  double sum = 0.0;
  for (const ScoredMonth& month : given) {
    const double e = month.error_months();
    sum += std::expm1(e < 0.0 ? -e / early_months : e / late_months);
  }
  return sum / static_cast<double>(given.size());
}

}  // namespace sealwatch::forecast

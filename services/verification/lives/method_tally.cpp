#include "services/verification/lives/method_tally.hpp"

#include <algorithm>
#include <cmath>

namespace sealwatch::verification {
namespace {

using forecast::Cluster;
using forecast::ScoredMonth;

constexpr double kLastYears_months = 36.0;  // that a life's rank among the worst is taken from
constexpr std::size_t kWorstLives = 5;

void add_value(std::vector<Cluster>& lives, const std::optional<double>& value) {
  lives.push_back(value ? Cluster{*value, 1} : Cluster{});
}

}  // namespace

Share share_of(int count, int of) {
  Share share{.of = of, .count = count, .interval = {}};
  if (const auto interval = forecast::clopper_pearson(count, of)) share.interval = *interval;
  return share;
}

Mean mean_of(std::span<const Cluster> lives) {
  const auto mean = forecast::clustered_mean(lives);
  if (!mean) return {};
  return {.known = true, .value = mean->mean, .standard_error = mean->standard_error, .lives = mean->lives};
}

Quantiles quantiles_of(std::vector<double> values) {
  Quantiles quantiles{.values = static_cast<int>(values.size()), .at = {}};
  if (values.empty()) return quantiles;
  std::sort(values.begin(), values.end());
  constexpr std::array kLevels{0.05, 0.25, 0.50, 0.75, 0.95};
  for (std::size_t k = 0; k < kLevels.size(); ++k) {
    const double place = kLevels[k] * static_cast<double>(values.size() - 1);
    const auto below = static_cast<std::size_t>(place);
    const auto above = std::min(below + 1, values.size() - 1);
    quantiles.at[k] = values[below] + (place - static_cast<double>(below)) * (values[above] - values[below]);
  }
  return quantiles;
}

std::optional<std::size_t> test_before_failure(const LifeRecord& record, double months) {
  std::optional<std::size_t> nearest;
  for (std::size_t k = 0; k < record.tests.size(); ++k) {
    const double off = std::abs(record.true_rul_months(k) - months);
    if (off <= 0.5 && (!nearest || off < std::abs(record.true_rul_months(*nearest) - months))) nearest = k;
  }
  return nearest;
}

void MethodTally::add(const LifeRecord& record, std::size_t method, std::size_t oracle) {
  ++lives_;
  const std::vector<ScoredMonth> months = scored_months(record, method);
  add_verdict(months);
  add_published_metrics(months);
  add_alpha_lambda(months, record.answers[method]);
  add_errors(record, months, scored_months(record, oracle));
  add_horizons(record, method);
  add_curve(months);
}

void MethodTally::add_verdict(std::span<const ScoredMonth> months) {
  const forecast::LifeVerdict verdict = forecast::judge_life(months);
  converged_ += verdict.converged ? 1 : 0;
  reliable_ += verdict.reliable ? 1 : 0;
  timely_ += verdict.timely ? 1 : 0;
  const auto of = [](const std::optional<forecast::StableSpan>& span, double forecast::StableSpan::*part) {
    return span ? std::optional((*span).*part) : std::nullopt;
  };
  add_value(antecedence_, of(verdict.reliable, &forecast::StableSpan::lead_months));
  add_value(error_, of(verdict.reliable, &forecast::StableSpan::mean_error_months));
  add_value(error_since_converged_, of(verdict.converged, &forecast::StableSpan::mean_error_months));
  if (verdict.reliable) antecedences_.push_back(verdict.reliable->lead_months);
  if (verdict.final_error_months) final_errors_.push_back(*verdict.final_error_months);
  add_value(final_error_,
            verdict.final_error_months ? std::optional(std::abs(*verdict.final_error_months)) : std::nullopt);
  add_value(last_year_error_, verdict.last_year_error_months);
  add_value(last_year_width_, verdict.last_year_width_months);
  const forecast::AlarmCounts& alarms = verdict.alarms;
  false_positive_.push_back({static_cast<double>(alarms.false_positive), alarms.not_due});
  false_negative_.push_back({static_cast<double>(alarms.false_negative), alarms.due});
}

void MethodTally::add_published_metrics(std::span<const ScoredMonth> months) {
  const forecast::PrognosticHorizon horizon = forecast::prognostic_horizon(months, kHorizonAlpha);
  add_value(horizon_first_, horizon.first);
  add_value(horizon_last_, horizon.stable);
  horizon_stable_ += horizon.stable ? 1 : 0;
  add_value(relative_accuracy_, forecast::cumulative_relative_accuracy(months));
  add_value(convergence_, forecast::convergence_distance(months));
  add_value(asymmetric_, forecast::asymmetric_score(months));
}

void MethodTally::add_alpha_lambda(std::span<const ScoredMonth> months, std::span<const RecordedAnswer> answers) {
  alpha_lambda_ +=
      forecast::alpha_lambda_accuracy(months, kAlphaLambdaAlpha, kAlphaLambdaLambda).value_or(false) ? 1 : 0;
  const auto judged = forecast::alpha_lambda_month(months, kAlphaLambdaLambda);
  const double mass = judged ? answers[*judged].mass_within_alpha : 0.0;  // silence gives it none
  alpha_lambda_mass_.push_back({mass, 1});
  alpha_lambda_by_mass_ += mass >= kAlphaLambdaBeta ? 1 : 0;
}

void MethodTally::add_errors(const LifeRecord& record, std::span<const ScoredMonth> months,
                             std::span<const ScoredMonth> oracle) {
  Cluster all, late;
  double own = 0.0, oracles = 0.0;
  for (std::size_t k = 0; k < months.size(); ++k) {
    if (!months[k].rul_months) continue;
    const double error = std::abs(months[k].error_months());
    all.sum += error;
    ++all.count;
    if (oracle[k].rul_months) {
      own += error;
      oracles += std::abs(oracle[k].error_months());
    }
    if (months[k].true_rul_months > kLastYears_months) continue;
    late.sum += error;
    ++late.count;
  }
  all_errors_.push_back(all);
  // Ratio of sums over the fleet: the denominator counts in hundredths of a month, so that one cluster carries both.
  oracle_ratio_.push_back({100.0 * own, static_cast<int>(std::lround(100.0 * oracles))});
  if (late.count > 0) worst_.push_back({record.life, late.sum / late.count});
}

void MethodTally::add_horizons(const LifeRecord& record, std::size_t method) {
  const std::vector<RecordedAnswer>& answers = record.answers[method];
  Cluster early;
  for (const RecordedAnswer& answer : answers) {
    if (answer.state != ForecastState::ok && answer.state != ForecastState::past_threshold) continue;
    early.sum += answer.pit < 0.10F ? 1.0 : 0.0;
    ++early.count;
  }
  before_p10_.push_back(early);
  for (std::size_t h = 0; h < kHorizons_months.size(); ++h) {
    const auto test = test_before_failure(record, kHorizons_months[h]);
    if (!test) continue;
    AtHorizon& at = horizons_[h];
    ++at.lives;
    const RecordedAnswer& answer = answers[*test];
    if (answer.state != ForecastState::ok && answer.state != ForecastState::past_threshold) continue;
    const double truth = record.true_rul_months(*test);
    const double tail = std::min(answer.pit, 1.0F - answer.pit);
    constexpr std::array kTails{0.25, 0.10, 0.025};
    for (std::size_t k = 0; k < kTails.size(); ++k) at.covered[k] += tail >= kTails[k] ? 1 : 0;
    at.error.push_back(answer.rul - truth);
    at.absolute_error.push_back({std::abs(answer.rul - truth), 1});
    at.crps.push_back({answer.crps, 1});
    at.width_95.push_back({answer.interval_95_high - answer.interval_95_low, 1});
    at.score_80.push_back({forecast::interval_score(answer.p10, answer.p90, 0.80, truth), 1});
    at.score_95.push_back({forecast::interval_score(answer.interval_95_low, answer.interval_95_high, 0.95, truth), 1});
    pit_.push_back(answer.pit);
  }
}

// A life counts as reliable k months before failure when every forecast from then on is within the tolerance.
void MethodTally::add_curve(std::span<const ScoredMonth> months) {
  const auto span = forecast::stable_span(months, forecast::LifeCriteria{}.reliable);
  const double age = months.empty() ? 0.0 : months.front().true_rul_months;
  for (int k = 0; k <= kCurveMonths; ++k) {
    if (k > age) break;
    ++seen_by_month_[static_cast<std::size_t>(k)];
    if (span && span->lead_months >= k) ++reliable_by_month_[static_cast<std::size_t>(k)];
  }
}

HorizonSummary MethodTally::finish(const AtHorizon& at, double months) const {
  HorizonSummary summary;
  summary.months = months;
  const int answered = static_cast<int>(at.error.size());
  summary.answered = share_of(answered, at.lives);
  for (std::size_t k = 0; k < at.covered.size(); ++k) summary.coverage[k] = share_of(at.covered[k], answered);
  summary.absolute_error = mean_of(at.absolute_error);
  summary.crps = mean_of(at.crps);
  summary.width_95 = mean_of(at.width_95);
  summary.interval_score_80 = mean_of(at.score_80);
  summary.interval_score_95 = mean_of(at.score_95);
  summary.error = quantiles_of(at.error);
  return summary;
}

MethodSummary MethodTally::finish() const {
  MethodSummary summary;
  summary.label = label_;
  summary.converged = share_of(converged_, lives_);
  summary.reliable = share_of(reliable_, lives_);
  summary.timely = share_of(timely_, lives_);
  summary.timely_of_converged = share_of(std::min(timely_, converged_), converged_);
  summary.horizon_stable = share_of(horizon_stable_, lives_);
  summary.alpha_lambda = share_of(alpha_lambda_, lives_);
  summary.alpha_lambda_by_mass = share_of(alpha_lambda_by_mass_, lives_);
  for (auto [mean, lives] : {std::pair{&summary.antecedence, &antecedence_},
                             {&summary.error, &error_},
                             {&summary.error_since_converged, &error_since_converged_},
                             {&summary.final_error, &final_error_},
                             {&summary.last_year_error, &last_year_error_},
                             {&summary.last_year_width, &last_year_width_},
                             {&summary.error_all_months, &all_errors_},
                             {&summary.false_positive, &false_positive_},
                             {&summary.false_negative, &false_negative_},
                             {&summary.before_p10, &before_p10_},
                             {&summary.oracle_ratio, &oracle_ratio_},
                             {&summary.alpha_lambda_mass, &alpha_lambda_mass_},
                             {&summary.horizon_first_months, &horizon_first_},
                             {&summary.horizon_stable_months, &horizon_last_},
                             {&summary.cumulative_relative_accuracy, &relative_accuracy_},
                             {&summary.convergence_distance, &convergence_},
                             {&summary.asymmetric_score, &asymmetric_}})
    *mean = mean_of(*lives);
  summary.final_error_box = quantiles_of(final_errors_);
  summary.antecedence_box = quantiles_of(antecedences_);
  for (std::size_t h = 0; h < kHorizons_months.size(); ++h)
    summary.horizons.push_back(finish(horizons_[h], kHorizons_months[h]));
  const std::vector<int> bins = forecast::histogram(pit_, kPitBins);
  std::copy(bins.begin(), bins.end(), summary.pit.begin());
  for (int k = 0; k <= kCurveMonths; ++k) {
    const auto month = static_cast<std::size_t>(k);
    if (seen_by_month_[month] > 0)
      summary.reliable_by_month.push_back(static_cast<double>(reliable_by_month_[month]) / seen_by_month_[month]);
  }
  summary.worst = worst_;
  std::stable_sort(summary.worst.begin(), summary.worst.end(),
                   [](const WorstLife& a, const WorstLife& b) { return a.error_months > b.error_months; });
  summary.worst.resize(std::min(summary.worst.size(), kWorstLives));
  return summary;
}

}  // namespace sealwatch::verification

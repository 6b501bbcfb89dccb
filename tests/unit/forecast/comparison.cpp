// Compares forecasters on the same random lives of the reference recursion: the table of docs/forecast.md.
//
//   forecast_comparison [LIVES] [SCENARIO] [STD] [FIRST] [CHANGE]
//     300 lives; scenario `reference` (random_life.hpp); 0: theta_std log-uniform in 0.003 .. 0.01, one for each life;
//     first seed 1; CHANGE is the forecasters' change_per_month
//
// Each life: one test a month until theta <= 0.60, each method after each test from the 12th on, scored by
// prognostic_metrics.hpp. Months that a scenario leaves out are not scored.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <map>
#include <random>
#include <string>

#include "sealwatch/forecast/forecaster.hpp"
#include "sealwatch/forecast/prognostic_metrics.hpp"
#include "sealwatch/forecast/proper_scores.hpp"
#include "services/verification/lives/oracle.hpp"
#include "tests/unit/forecast/random_life.hpp"

using namespace sealwatch;
using namespace sealwatch::forecast;

namespace {

constexpr double kThreshold = 0.60;
constexpr int kFirstMonth = 12;
constexpr std::array<double, 4> kLeads{36.0, 24.0, 12.0, 6.0};
constexpr std::array<std::pair<double, double>, 3> kRanges{{{0.0, 12.0}, {12.0, 36.0}, {36.0, 72.0}}};

struct Tally {
  int lives = 0, reliable = 0, converged = 0, timely = 0, false_negative = 0, due = 0, false_positive = 0, not_due = 0;
  double antecedence = 0.0, reliable_error = 0.0;
  std::vector<Cluster> last_year, before_p10, young;
  std::array<std::vector<Cluster>, 3> errors, crps;
  std::array<std::array<int, 4>, 3> inside{};  ///< of 50, 80, 95 %, at each lead
  std::array<int, 4> at_lead{};
  double seconds = 0.0;
  long forecasts = 0;
};

struct OneLife {
  std::vector<ScoredMonth> months;
  Cluster last_year, before_p10, young;  ///< young: relative errors before the 24th month
  std::array<Cluster, 3> errors, crps;
};

void add(Cluster& cluster, double value) {
  cluster.sum += value;
  ++cluster.count;
}

void score(Tally& tally, OneLife& life, const ScoredMonth& month, const PredictiveDistribution* distribution) {
  life.months.push_back(month);
  if (!month.rul_months) return;
  const double left = month.true_rul_months;
  const double error = std::abs(month.error_months());
  if (left <= 12.0) add(life.last_year, error);
  if (month.time_months < 24.0) add(life.young, error / left);
  if (distribution) add(life.before_p10, left < distribution->quantile(0.10));
  for (std::size_t r = 0; r < kRanges.size(); ++r) {
    if (left <= kRanges[r].first || left > kRanges[r].second) continue;
    add(life.errors[r], error);
    add(life.crps[r], distribution ? distribution->crps(left) : left);
  }
  if (!distribution) return;
  const double p = distribution->cdf(left);
  for (std::size_t k = 0; k < kLeads.size(); ++k) {
    if (std::abs(left - kLeads[k]) > 0.5) continue;
    ++tally.at_lead[k];
    tally.inside[0][k] += std::abs(p - 0.5) <= 0.25;
    tally.inside[1][k] += std::abs(p - 0.5) <= 0.40;
    tally.inside[2][k] += std::abs(p - 0.5) <= 0.475;
  }
}

void close(Tally& tally, OneLife& life) {
  const LifeVerdict verdict = judge_life(life.months);
  ++tally.lives;
  tally.converged += verdict.converged.has_value();
  tally.timely += verdict.timely;
  tally.false_negative += verdict.alarms.false_negative;
  tally.false_positive += verdict.alarms.false_positive;
  tally.due += verdict.alarms.due;
  tally.not_due += verdict.alarms.not_due;
  if (verdict.reliable) {
    ++tally.reliable;
    tally.antecedence += verdict.reliable->lead_months;
    tally.reliable_error += verdict.reliable->mean_error_months;
  }
  tally.last_year.push_back(life.last_year);
  tally.before_p10.push_back(life.before_p10);
  tally.young.push_back(life.young);
  for (std::size_t r = 0; r < kRanges.size(); ++r) {
    tally.errors[r].push_back(life.errors[r]);
    tally.crps[r].push_back(life.crps[r]);
  }
}

std::vector<ConditionSample> without_outliers(const std::vector<ConditionSample>& history) {
  const std::vector<bool> outlier = isolated_outliers(history);
  std::vector<ConditionSample> kept;
  for (std::size_t i = 0; i < history.size(); ++i)
    if (!outlier[i]) kept.push_back(history[i]);
  return kept;
}

double mean(const std::vector<Cluster>& clusters) {
  const auto result = clustered_mean(clusters);
  return result ? result->mean : 0.0;
}

void print(const std::string& name, const Tally& t) {
  const double n = t.lives;
  const auto p10 = clustered_mean(t.before_p10);
  std::printf(
      "%-15s %5.1f %5.1f %5.1f %6.1f %5.2f | %5.2f | %5.2f %5.2f %5.2f | %5.2f %5.2f %5.2f | %4.1f+-%3.1f | %4.1f "
      "%4.1f |",
      name.c_str(), 100 * t.reliable / n, 100 * t.converged / n, 100 * t.timely / n,
      t.antecedence / std::max(t.reliable, 1), t.reliable_error / std::max(t.reliable, 1), mean(t.last_year),
      mean(t.errors[0]), mean(t.errors[1]), mean(t.errors[2]), mean(t.crps[0]), mean(t.crps[1]), mean(t.crps[2]),
      p10 ? 100 * p10->mean : 0.0, p10 ? 200 * p10->standard_error : 0.0,
      100.0 * t.false_positive / std::max(t.not_due, 1), 100.0 * t.false_negative / std::max(t.due, 1));
  for (std::size_t k = 0; k < kLeads.size(); ++k) {
    const int trials = std::max(t.at_lead[k], 1);
    std::printf(" %3d/%d/%d", 100 * t.inside[0][k] / trials, 100 * t.inside[1][k] / trials,
                100 * t.inside[2][k] / trials);
  }
  std::printf(" | %3.0f | %.3f\n", 100.0 * mean(t.young),
              t.forecasts ? 1e3 * t.seconds / static_cast<double>(t.forecasts) : 0.0);
}

}  // namespace

int main(int argc, char** argv) {
  const int lives = argc > 1 ? std::atoi(argv[1]) : 300;
  const std::string scenario = argc > 2 ? argv[2] : "reference";
  const double fixed_std = argc > 3 ? std::atof(argv[3]) : 0.0;
  const int first = argc > 4 ? std::atoi(argv[4]) : 1;
  std::vector<ForecasterSettings> settings{{"ols", 24},          {"ols", 36},          {"ols", 48},
                                           {"ols_fieller", 36},  {"ols_log_time", 36}, {"ols_drift", 36},
                                           {"state_space", 240}, {"fleet", 240}};
  settings.push_back({"average", 240});
  if (argc > 5)
    for (ForecasterSettings& one : settings) one.change_per_month = std::atof(argv[5]);
  std::vector<std::unique_ptr<const Forecaster>> forecasters;
  for (const ForecasterSettings& one : settings)
    if (auto made = make_forecaster(one)) forecasters.push_back(std::move(*made));
  std::vector<Tally> tallies(forecasters.size() + 1);
  for (int seed = first; seed < first + lives; ++seed) {
    const test::RandomLife life = test::random_life(static_cast<std::uint64_t>(seed), scenario, fixed_std, kThreshold);
    std::vector<OneLife> of_life(tallies.size());
    ForecastRequest request{.threshold = kThreshold};
    if (life.installation_known) request.installed = test::kInstalled;
    for (const test::MonthOfLife& month : life.months) {
      if (month.sample) request.history.push_back(*month.sample);
      const double left = life.end_months - month.state.month;
      if (!month.sample || !month.foreseeable || month.state.month < kFirstMonth || left <= 0.0) continue;
      request.now = month.sample->time;
      const ForecastRequest whole = request;
      request.history = without_outliers(request.history);  // as the panel does
      for (std::size_t f = 0; f < forecasters.size(); ++f) {
        const std::clock_t begin = std::clock();
        const PredictiveForecast predicted = forecasters[f]->predict(request).value();
        tallies[f].seconds += static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
        ++tallies[f].forecasts;
        score(tallies[f], of_life[f], scored_month(predicted.forecast, month.state.month, left),
              predicted.distribution ? &*predicted.distribution : nullptr);
      }
      request.history = whole.history;
      const auto known = oracle_distribution(month.state, kThreshold);
      if (!known) continue;
      score(tallies.back(), of_life.back(),
            {.time_months = month.state.month, .true_rul_months = left, .rul_months = known->quantile(0.5)}, &*known);
    }
    for (std::size_t f = 0; f < tallies.size(); ++f) close(tallies[f], of_life[f]);
  }
  std::printf(
      "%s, %d lives\n%-15s %5s %5s %5s %6s %5s | %5s | %17s | %17s | %9s | %9s | coverage 50/80/95 at 36 24 12 6 | "
      "ms\n",
      scenario.c_str(), lives, "method", "rel%", "conv", "timel", "antec", "err", "lastY", "|e| <12 <36 <72",
      "CRPS <12 <36 <72", "<P10 %2SE", "FP% FN%");
  for (std::size_t f = 0; f < forecasters.size(); ++f)
    print(settings[f].method + std::to_string(settings[f].window_months), tallies[f]);
  print("oracle", tallies.back());
  return 0;
}

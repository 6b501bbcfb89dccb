#include "services/verification/lives/summary.hpp"

#include <cmath>

#include "services/verification/lives/method_tally.hpp"

namespace sealwatch::verification {
namespace {

using forecast::Cluster;
using forecast::ScoredMonth;

constexpr double kMonthsAYear = 12.0;
constexpr double kNormal97_5 = 1.959963984540054;

/// What is collected of lives whatever the method.
struct FleetTally {
  std::vector<double> lifetime_years;
  std::vector<Cluster> chi_square, standard_error;
  std::vector<forecast::Feature> estimates;
  int within_95 = 0, judged = 0;
};

void add_estimates(const LifeRecord& record, Summary& summary, FleetTally& fleet) {
  Cluster chi_square, standard_error;
  forecast::Feature estimates;
  summary.tests += static_cast<std::int64_t>(record.tests.size());
  for (const RecordedTest& test : record.tests) {
    if (!test.usable) {
      ++summary.unusable_tests;
      continue;
    }
    estimates.push_back(test.estimate);
    standard_error.sum += test.estimate_std;
    chi_square.sum += std::pow((test.estimate - test.condition) / test.estimate_std, 2);
    ++standard_error.count;
    ++chi_square.count;
  }
  fleet.chi_square.push_back(chi_square);
  fleet.standard_error.push_back(standard_error);
  if (!record.censored && estimates.size() >= 2) fleet.estimates.push_back(std::move(estimates));
  if (record.tests.empty()) return;
  const RecordedTest& middle = record.tests[record.tests.size() / 2];
  if (!middle.usable) return;
  ++fleet.judged;
  fleet.within_95 += std::abs(middle.estimate - middle.condition) <= kNormal97_5 * middle.estimate_std ? 1 : 0;
}

void finish(const FleetTally& fleet, Summary& summary) {
  summary.lifetime_years = quantiles_of(fleet.lifetime_years);
  int in_range = 0;
  for (const double years : fleet.lifetime_years) in_range += years >= 8.0 && years <= 20.0 ? 1 : 0;
  summary.fails_in_8_to_20_years = share_of(in_range, summary.lives);
  summary.estimate_chi_square = mean_of(fleet.chi_square);
  summary.estimate_std = mean_of(fleet.standard_error);
  summary.estimate_within_95 = share_of(fleet.within_95, fleet.judged);
  summary.monotonicity = forecast::monotonicity(fleet.estimates).value_or(0.0);
  summary.trendability = forecast::trendability(fleet.estimates).value_or(0.0);
  summary.prognosability = forecast::prognosability(fleet.estimates).value_or(0.0);
}

}  // namespace

std::vector<ScoredMonth> scored_months(const LifeRecord& record, std::size_t method) {
  std::vector<ScoredMonth> months;
  months.reserve(record.tests.size());
  for (std::size_t k = 0; k < record.tests.size(); ++k) {
    const RecordedAnswer& answer = record.answers[method][k];
    ScoredMonth month{.time_months = record.tests[k].time_months,
                      .true_rul_months = record.true_rul_months(k),
                      .rul_months = std::nullopt};
    if (answer.state == ForecastState::past_threshold) month.rul_months = 0.0;
    if (answer.state == ForecastState::ok) {
      month.rul_months = answer.rul;
      month.width_95_months = answer.interval_95_high - answer.interval_95_low;
    }
    months.push_back(month);
  }
  return months;
}

Result<Summary> summarise(std::uint32_t lives, const std::vector<std::string>& labels,
                          const std::function<Result<LifeRecord>(std::uint32_t)>& read) {
  if (lives == 0) return fail("an empty fleet verifies nothing", "give at least one life");
  Summary summary;
  FleetTally fleet;
  std::vector<MethodTally> tallies(labels.begin(), labels.end());
  for (std::uint32_t life = 0; life < lives; ++life) {
    const Result<LifeRecord> record = read(life);
    if (!record) return fail(record.error());
    if (record->answers.size() != labels.size())
      return fail("life " + std::to_string(life) + " has " + std::to_string(record->answers.size()) + " methods, not " +
                  std::to_string(labels.size()));
    ++summary.lives;
    fleet.lifetime_years.push_back(record->end_of_life_months / kMonthsAYear);
    add_estimates(*record, summary, fleet);
    if (record->censored) {
      ++summary.censored;
      continue;
    }
    for (std::size_t method = 0; method < labels.size(); ++method)
      tallies[method].add(*record, method, labels.size() - 1);
  }
  finish(fleet, summary);
  for (const MethodTally& tally : tallies) summary.methods.push_back(tally.finish());
  return summary;
}

}  // namespace sealwatch::verification

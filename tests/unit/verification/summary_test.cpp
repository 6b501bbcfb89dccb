// The measures on made-up answers whose result is known by hand.
#include "services/verification/lives/summary.hpp"

#include <gtest/gtest.h>

#include "services/verification/lives/method_tally.hpp"

namespace sealwatch::verification {
namespace {

constexpr int kTests = 60;

RecordedAnswer answer(double rul, double half_width = 2.0) {
  const auto f = [](double value) { return static_cast<float>(value); };
  return {ForecastState::ok,
          f(rul),
          f(rul - half_width),
          f(rul + half_width),
          f(rul - 1.0),
          f(rul + 1.0),
          0.5F,
          0.25F,
          0.75F};
}

/// A life of 60 tests that ends half a month after the last; methods: 2 months late, 8 months late, silent, oracle (1
/// late).
LifeRecord life(std::uint32_t number) {
  LifeRecord record;
  record.life = number;
  record.end_of_life_months = kTests + 0.5;
  record.answers.resize(4);
  for (int k = 1; k <= kTests; ++k) {
    const double condition = 1.0 - 0.4 * k / record.end_of_life_months;
    record.tests.push_back({static_cast<double>(k), condition, true, condition + (k % 2 == 0 ? 0.001 : -0.001), 0.001});
    const double truth = record.end_of_life_months - k;
    record.answers[0].push_back(answer(truth + 2.0));
    record.answers[1].push_back(answer(truth + 8.0));
    record.answers[2].push_back({});
    record.answers[3].push_back(answer(truth + 1.0));
  }
  return record;
}

const std::vector<std::string> kLabels{"two", "eight", "silent", "oracle"};

Summary summary_of(std::uint32_t lives, bool one_censored = false) {
  return summarise(lives, kLabels,
                   [&](std::uint32_t k) -> Result<LifeRecord> {
                     LifeRecord record = life(k);
                     record.censored = one_censored && k == 0;
                     return record;
                   })
      .value();
}

TEST(Summary, OfAConstantErrorWithinTheTolerance) {
  const MethodSummary two = summary_of(10).methods[0];
  EXPECT_EQ(two.label, "two");
  EXPECT_EQ(two.reliable.count, 10);
  EXPECT_EQ(two.converged.count, 10);
  EXPECT_EQ(two.timely.count, 10);
  EXPECT_DOUBLE_EQ(two.antecedence.value, kTests - 0.5);  // reliable from the first test on
  EXPECT_NEAR(two.error.value, 2.0, 1e-5);
  EXPECT_NEAR(two.final_error.value, 2.0, 1e-5);
  EXPECT_NEAR(two.last_year_error.value, 2.0, 1e-5);
  EXPECT_NEAR(two.last_year_width.value, 4.0, 1e-5);
  EXPECT_NEAR(two.oracle_ratio.value, 2.0, 1e-3);
  EXPECT_EQ(two.before_p10.value, 0.0);
  EXPECT_EQ(two.false_positive.value, 0.0);
  // Late by two months: the alarm is missing in the two months with 10 to 12 left, of the last twelve.
  EXPECT_NEAR(two.false_negative.value, 2.0 / 12.0, 1e-9);
  EXPECT_EQ(two.reliable_by_month.front(), 1.0);
  EXPECT_EQ(two.horizons[2].answered.count, 10);
  EXPECT_EQ(two.horizons[2].coverage[2].count, 10);
  EXPECT_NEAR(two.horizons[2].crps.value, 0.25, 1e-6);
  EXPECT_NEAR(two.horizons[2].error.at[2], 2.0, 1e-5);
  int forecasts = 0;
  for (const int count : two.pit) forecasts += count;
  EXPECT_EQ(forecasts, 40);
  EXPECT_EQ(two.pit[kPitBins / 2], 40);
}

TEST(Summary, OfAnErrorBeyondTheToleranceAndOfSilence) {
  const Summary summary = summary_of(10);
  EXPECT_EQ(summary.methods[1].reliable.count, 0);  // 8 months: outside 3 months near the end
  EXPECT_EQ(summary.methods[1].converged.count, 0);
  EXPECT_FALSE(summary.methods[1].antecedence.known);
  EXPECT_NEAR(summary.methods[1].final_error.value, 8.0, 1e-5);
  EXPECT_EQ(summary.methods[2].reliable.count, 0);
  EXPECT_EQ(summary.methods[2].horizons[0].answered.count, 0);
  EXPECT_EQ(summary.methods[2].horizons[0].answered.of, 10);
  EXPECT_FALSE(summary.methods[2].error_all_months.known);
  EXPECT_NEAR(summary.methods[2].false_negative.value, 1.0, 1e-12);
  EXPECT_TRUE(summary.methods[2].worst.empty());
  EXPECT_EQ(summary.methods[1].worst.size(), 5U);
}

// Judged at half of the way from the first number on; every forecast gives 0.75 to what alpha-lambda tolerates.
TEST(Summary, AlphaLambdaAsProbabilityMass) {
  const Summary summary = summary_of(10);
  EXPECT_NEAR(summary.methods[0].alpha_lambda_mass.value, 0.75, 1e-7);
  EXPECT_EQ(summary.methods[0].alpha_lambda_by_mass.count, 10);
  EXPECT_EQ(summary.methods[2].alpha_lambda_mass.value, 0.0);  // silence
  EXPECT_EQ(summary.methods[2].alpha_lambda_by_mass.count, 0);
  EXPECT_EQ(summary.methods[2].alpha_lambda_by_mass.of, 10);
  // Only the judged month counts: with the first number at month 1 and the end at 60.5 that is month 30.
  const auto read = [](int spoiled) {
    return [spoiled](std::uint32_t k) -> Result<LifeRecord> {
      LifeRecord record = life(k);
      record.answers[0][static_cast<std::size_t>(spoiled - 1)].mass_within_alpha = 0.25F;
      return record;
    };
  };
  EXPECT_EQ(summarise(4, kLabels, read(30)).value().methods[0].alpha_lambda_by_mass.count, 0);
  EXPECT_EQ(summarise(4, kLabels, read(29)).value().methods[0].alpha_lambda_by_mass.count, 4);
  EXPECT_EQ(summarise(4, kLabels, read(31)).value().methods[0].alpha_lambda_by_mass.count, 4);
}

TEST(Summary, IntervalsAreThoseOfTheLives) {
  const Share share = share_of(85, 100);
  EXPECT_NEAR(share.interval.low, 0.765, 0.001);  // why 100 lives cannot tell 85 % from 90 %
  EXPECT_NEAR(share.interval.high, 0.914, 0.001);
  EXPECT_EQ(share_of(0, 0).value(), 0.0);
  EXPECT_FALSE(mean_of({}).known);
  const Quantiles q = quantiles_of({3.0, 1.0, 2.0});
  EXPECT_EQ(q.at[2], 2.0);
  EXPECT_NEAR(q.at[0], 1.1, 1e-12);
  EXPECT_EQ(quantiles_of({}).values, 0);
}

TEST(Summary, LivesThatOutlastTheServiceAreCountedAndLeftOut) {
  const Summary summary = summary_of(10, true);
  EXPECT_EQ(summary.lives, 10);
  EXPECT_EQ(summary.censored, 1);
  EXPECT_EQ(summary.methods[0].reliable.of, 9);
  EXPECT_EQ(summary.tests, 600);
  EXPECT_NEAR(summary.estimate_chi_square.value, 1.0, 1e-9);
  EXPECT_EQ(summary.estimate_within_95.count, 10);
}

TEST(Summary, RefusesAnEmptyFleetAndForeignRecords) {
  const auto read = [](std::uint32_t k) -> Result<LifeRecord> { return life(k); };
  EXPECT_FALSE(summarise(0, kLabels, read));
  EXPECT_FALSE(summarise(3, {"two", "oracle"}, read));
  EXPECT_FALSE(summarise(3, kLabels, [](std::uint32_t) -> Result<LifeRecord> { return fail("gone"); }));
}

}  // namespace
}  // namespace sealwatch::verification

// What a scenario changes of a life, and that it changes nothing else.
#include "services/verification/lives/scenario.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "services/verification/lives/setting.hpp"
#include "services/virtual_bench/random.hpp"

namespace sealwatch::verification {
namespace {

constexpr double kThreshold = 0.6;
constexpr std::uint64_t kSeed = 7;
constexpr int kLives = 200;

SealLife life_of(Scenario scenario, std::uint64_t seed = kSeed) {
  return seal_life(seed, published_ln_t(), kThreshold, scenario);
}

bench::PlannedTest test_of(int month, Scenario scenario, std::uint64_t seed = kSeed) {
  bench::PlannedTest planned;
  planned.month = month;
  planned.load_factor = 0.1;
  return as_it_comes(
      planned,
      ConditionSetting{
          .parameter = "R_CL", .at_100 = 2.6e13, .at_60 = 4.64e12, .unit = "Pa s/m3", .part = "piston seal"},
      life_of(scenario, seed), seed, scenario);
}

TEST(Scenario, NamesGoBothWays) {
  for (const Scenario scenario : all_scenarios())
    EXPECT_EQ(scenario_named(std::string(name_of(scenario))).value(), scenario);
  const auto wrong = scenario_named("outlier");
  ASSERT_FALSE(wrong);
  EXPECT_NE(wrong.error().describe().find("did you mean 'outliers'?"), std::string::npos);
}

TEST(Scenario, TheReferenceIsTheSealOfItsStream) {
  const SealLife life = life_of(Scenario::reference);
  forecast::Degradation seal(bench::sub_seed(kSeed, "seal"), published_ln_t());
  for (std::size_t month = 1; month < life.months.size(); ++month) {
    EXPECT_EQ(life.months[month].condition, seal.advance());
    EXPECT_EQ(life.months[month].gamma, seal.gamma());
  }
  const std::size_t last = life.months.size() - 1;
  EXPECT_LE(life.months[last].condition, kThreshold);
  EXPECT_GT(life.months[last - 1].condition, kThreshold);
  EXPECT_GT(life.end_of_life_months, static_cast<double>(last) - 1.0);
  EXPECT_LE(life.end_of_life_months, static_cast<double>(last));
  EXPECT_EQ(life.scored_from_months, 0.0);
}

TEST(Scenario, ContaminationAgesOneAndAHalfTimesAsFastFromItsMonthOn) {
  const SealLife plain = life_of(Scenario::reference), hit = life_of(Scenario::contamination);
  const auto change = static_cast<std::size_t>(hit.change_months);
  ASSERT_GT(change, 12u);
  for (std::size_t month = 1; month <= change; ++month)
    EXPECT_EQ(hit.months[month].condition, plain.months[month].condition);
  for (std::size_t month = change + 1; month < hit.months.size(); ++month) {
    const double fall = plain.months[month - 1].condition - plain.months[month].condition;
    EXPECT_NEAR(hit.months[month - 1].condition - hit.months[month].condition, 1.5 * fall, 1e-12);
    EXPECT_DOUBLE_EQ(hit.months[month].gamma, 1.5 * plain.months[month].gamma);
  }
  EXPECT_LT(hit.end_of_life_months, plain.end_of_life_months);
  EXPECT_EQ(hit.scored_from_months, hit.change_months + 6.0);
  EXPECT_DOUBLE_EQ(hit.law.irregularity.max, 1.5 * published_ln_t().irregularity.max);
}

TEST(Scenario, ReplacedIsASecondSealFromTheMonthAfterOn) {
  for (std::uint64_t seed = 1; seed <= kLives; ++seed) {
    const SealLife life = life_of(Scenario::replaced, seed);
    const auto change = static_cast<std::size_t>(life.change_months);
    ASSERT_GE(life.months.size(), change + 2);
    EXPECT_LE(change, 72u);
    EXPECT_EQ(life.installed_months, life.change_months);
    EXPECT_EQ(life.months[change].month, life.change_months);
    EXPECT_EQ(life.months[change + 1].month, 1.0);
    EXPECT_GT(life.months[change + 1].condition, 0.9);
    EXPECT_GT(life.months[change].condition, kThreshold);
    EXPECT_LE(life.months.back().condition, kThreshold);
    EXPECT_NEAR(life.end_of_life_months, static_cast<double>(life.months.size()) - 1.5, 0.5);
  }
}

TEST(Scenario, OneTestInTwentyIsAnOutlier) {
  int off = 0, tests = 0;
  for (std::uint64_t seed = 1; seed <= kLives; ++seed)
    for (const int month : {10, 20, 30, 40, 50}) {
      const SealLife own = life_of(Scenario::outliers, seed);
      const double error = std::abs(test_of(month, Scenario::outliers, seed).condition -
                                    own.months[static_cast<std::size_t>(month)].condition);
      ++tests;
      if (error == 0.0) continue;
      ++off;
      EXPECT_GE(error, 0.02 - 1e-12);
      EXPECT_LE(error, 0.10 + 1e-12);
    }
  const double expected = 0.05 * tests;
  EXPECT_NEAR(off, expected, 4.0 * std::sqrt(0.95 * expected));  // one chance in 16 000
}

TEST(Scenario, LoadRisesFromItsMonthOnAndTheSealIsTheSame) {
  const SealLife plain = life_of(Scenario::reference), loaded = life_of(Scenario::load_change);
  EXPECT_EQ(loaded.end_of_life_months, plain.end_of_life_months);
  const int change = static_cast<int>(loaded.change_months);
  EXPECT_DOUBLE_EQ(test_of(change, Scenario::load_change).load_factor, 0.1);
  EXPECT_DOUBLE_EQ(test_of(change + 1, Scenario::load_change).load_factor, 0.4);
  EXPECT_EQ(test_of(change + 1, Scenario::load_change).resistance_Pa_s_m3,
            test_of(change + 1, Scenario::reference).resistance_Pa_s_m3);
}

TEST(Scenario, SharesOfMissingAndCutTests) {
  EXPECT_EQ(shares_of(Scenario::missing).missing, 0.25);
  EXPECT_EQ(shares_of(Scenario::aborted).cut, 0.25);
  EXPECT_EQ(shares_of(Scenario::outliers).missing, 0.0);
  EXPECT_EQ(shares_of(Scenario::reference).cut, 0.0);
}

}  // namespace
}  // namespace sealwatch::verification

#include <gtest/gtest.h>

#include <cmath>

#include "services/virtual_bench/simulate_life.hpp"
#include "tests/unit/virtual_bench/nominal.hpp"

namespace sealwatch::bench {
namespace {

std::vector<PlannedTest> plan(const LifeSetting& setting) { return plan_life(nominal_asset(), setting).value(); }

TEST(Life, EndsWithTheFirstTestAtTheThreshold) {
  const std::vector<PlannedTest> tests = plan({.seed = 3, .months = 1000});
  for (std::size_t k = 0; k + 1 < tests.size(); ++k) EXPECT_GT(tests[k].condition, 0.60);
  EXPECT_LE(tests.back().condition, 0.60);
  EXPECT_EQ(plan({.seed = 3, .months = 24}).size(), 24U);
}

TEST(Life, TestsComeMonthly) {
  const UtcTime installed = parse_utc("2009-02-01").value();
  const std::vector<PlannedTest> tests = plan({.seed = 3, .installed = installed, .day_scatter = 10.0});
  for (std::size_t k = 0; k < tests.size(); ++k) {
    const double months = months_between(installed, tests[k].start_time);
    EXPECT_EQ(tests[k].month, static_cast<int>(k) + 1);
    EXPECT_GE(months, tests[k].month - 1e-6);
    EXPECT_LE(months, tests[k].month + 0.33);  // ten days
    EXPECT_LE(std::abs(tests[k].load_factor), 0.2);
  }
}

TEST(Life, MissingAndCutMonthsDoNotChangeTheRest) {
  const std::vector<PlannedTest> whole = plan({.seed = 3});
  const std::vector<PlannedTest> gaps = plan({.seed = 3, .missing_share = 0.2, .cut_share = 0.1});
  ASSERT_EQ(gaps.size(), whole.size());
  int missing = 0, cut = 0;
  for (std::size_t k = 0; k < whole.size(); ++k) {
    EXPECT_EQ(gaps[k].condition, whole[k].condition);
    EXPECT_EQ(gaps[k].load_factor, whole[k].load_factor);
    EXPECT_EQ(gaps[k].start_time, whole[k].start_time);
    EXPECT_EQ(whole[k].recorded_share, 1.0);
    missing += gaps[k].recorded_share == 0.0 ? 1 : 0;
    cut += gaps[k].recorded_share > 0.0 && gaps[k].recorded_share < 1.0 ? 1 : 0;
  }
  const double months = static_cast<double>(whole.size());
  EXPECT_NEAR(missing, 0.2 * months, 4.0 * std::sqrt(0.16 * months));  // four sigma of a binomial count
  EXPECT_NEAR(cut, 0.08 * months, 4.0 * std::sqrt(0.075 * months));
}

TEST(Life, SimulatesWhatWasPlanned) {
  const LifeSetting life{
      .seed = 5, .months = 12, .installed = parse_utc("2030-01-01").value(), .missing_share = 0.3, .cut_share = 0.3};
  const auto tests = simulate_life(nominal_asset(), life, {.sample_rate_Hz = 50.0});
  ASSERT_TRUE(tests) << tests.error().describe();
  std::size_t recorded = 0;
  for (const PlannedTest& test : plan(life)) recorded += test.recorded_share > 0.0 ? 1U : 0U;
  EXPECT_EQ(tests->size(), recorded);
  EXPECT_LT(recorded, 12U);
  const std::size_t whole = run(nominal_asset(), {}, {.sample_rate_Hz = 50.0}).samples.time_s.size();
  for (const LifeTest& test : *tests) {
    const double share = static_cast<double>(test.recording.samples.time_s.size()) / static_cast<double>(whole);
    EXPECT_NEAR(share, test.plan.recorded_share, 1e-3);
    EXPECT_EQ(test.recording.start_time, test.plan.start_time);
    EXPECT_EQ(test.recording.recording_id, format_date(test.plan.start_time) + "-PST-XT03-MV2");
    EXPECT_EQ(test.recording.asset_id, "XT03-MV2");
    for (const Series& channel : test.recording.samples.channels)
      EXPECT_EQ(channel.values.size(), test.recording.samples.time_s.size());
  }
  EXPECT_EQ(simulate_life(nominal_asset(), life, {.sample_rate_Hz = 50.0})->front().recording.samples,
            tests->front().recording.samples);
}

TEST(Life, NeedsSealResistances) {
  AssetConfig asset = nominal_asset();
  asset.condition.reset();
  EXPECT_FALSE(plan_life(asset, {}));
}

}  // namespace
}  // namespace sealwatch::bench

#include "services/health_assessment/grade.hpp"

#include <gtest/gtest.h>

#include "services/health_assessment/trend.hpp"
#include "tests/unit/layers/state_detection/synthetic_test.hpp"

namespace sealwatch {
namespace {

StateReport with_seal_at(double theta) {
  StateReport report;
  report.verdict = PstVerdict::passed;
  const ConditionSetting seal{
      .parameter = "R_CL", .at_100 = 2.6e13, .at_60 = 4.64e12, .unit = "Pa s/m3", .part = "piston seal"};
  report.judgements = {{"leakage_resistance", Reference::limit, "Pa s/m3", seal.value(theta), 1e13, 7e12, 4e12,
                        AlertRegion::normal, AlertRegion::normal, 1}};
  return report;
}

double grade(const StateReport& report) {
  return health_grade(synthetic::asset(), report, deviations_of(report), 1.0).value();
}

TEST(Grade, FollowsTheSealFromAsNewToTheThreshold) {
  EXPECT_NEAR(grade(with_seal_at(1.0)), 1.0, 1e-12);
  EXPECT_NEAR(grade(with_seal_at(0.8)), 0.5, 1e-12);
  EXPECT_NEAR(grade(with_seal_at(0.6)), 0.0, 1e-12);
  EXPECT_EQ(grade(with_seal_at(0.5)), 0.0);
  EXPECT_EQ(grade(with_seal_at(1.1)), 1.0);
}

TEST(Grade, AWorseRegionElsewhereLowersIt) {
  StateReport report = with_seal_at(0.95);
  report.judgements.push_back({"friction_pressure", Reference::own_baseline, "Pa", 5e5, 4.5e5, 5e5, 5.5e5,
                               AlertRegion::alarm, AlertRegion::warning, 2});
  EXPECT_NEAR(grade(report), 0.5, 1e-12);
}

TEST(Grade, SensorsAndLoadDoNotLowerIt) {
  StateReport report = with_seal_at(0.95);
  for (const char* name : {"channel.flow", "flow_gain", "load_pressure", "residual.flow"})
    report.judgements.push_back({name, Reference::limit, "1", 1, 1, 2, 3, AlertRegion::alarm, AlertRegion::alarm, 5});
  EXPECT_NEAR(grade(report), 0.875, 1e-12);
}

TEST(Grade, WhereTheLeakageIsNotMeasuredTheLastGradeStays) {
  StateReport report;
  report.verdict = PstVerdict::passed;
  EXPECT_EQ(health_grade(synthetic::asset(), report, {}, 0.4), 0.4);
  EXPECT_FALSE(health_grade(synthetic::asset(), report, {}, std::nullopt)) << "never measured is not as new";
}

TEST(Grade, OfWhatElseWearsFollowsItsCondition) {
  AssetConfig packing = synthetic::asset();
  packing.condition = ConditionSetting{.parameter = "f_C", .at_100 = 2e6, .at_60 = 4e6, .threshold = 0.6};
  StateReport report = with_seal_at(0.95);  // a seal that the condition does not speak of
  report.judgements.push_back(
      {"condition", Reference::limit, "1", 0.7, 0.7, 0.65, 0.6, AlertRegion::normal, AlertRegion::normal, 1});
  const auto grade_of = [&] { return health_grade(packing, report, deviations_of(report), 1.0).value(); };
  EXPECT_NEAR(grade_of(), 0.25, 1e-12);
  report.judgements.push_back({"friction_pressure", Reference::own_baseline, "Pa", 5e5, 4.5e5, 5e5, 5.5e5,
                               AlertRegion::alarm, AlertRegion::alarm, 2});
  EXPECT_NEAR(grade_of(), 0.25, 1e-12) << "the lower of both";
}

TEST(Grade, AFailedTestIsZero) {
  StateReport report = with_seal_at(0.95);
  report.verdict = PstVerdict::failed;
  EXPECT_EQ(grade(report), 0.0);
}

TEST(Grade, WithoutSealResistancesTheDeviationCounts) {
  AssetConfig asset = synthetic::asset();
  asset.condition.reset();
  StateReport report;
  report.verdict = PstVerdict::passed;
  report.judgements = {{"leakage_resistance", Reference::own_baseline, "Pa s/m3", 5.5e12, 7e12, 4e12, 1e12,
                        AlertRegion::advisory, AlertRegion::normal, 1}};
  EXPECT_NEAR(health_grade(asset, report, deviations_of(report), 1.0).value(), 0.5,
              1e-12);  // one and a half of three widths
}

std::vector<GradeAt> line(double slope_per_year, double wiggle, int count) {
  std::vector<GradeAt> grades;
  for (int k = 0; k < count; ++k)
    grades.push_back({synthetic::month(k), 0.9 + slope_per_year * k / 12.0 + (k % 2 == 0 ? wiggle : -wiggle)});
  return grades;
}

TEST(Trend, AStraightLineIsExact) {
  const auto trend = trend_of(line(-0.06, 0.0, 24));
  ASSERT_TRUE(trend);
  EXPECT_NEAR(trend->slope_per_year, -0.06, 1e-9);
  EXPECT_NEAR(trend->std_per_year, 0.0, 1e-9);
}

TEST(Trend, ScatterIsInTheStandardError) {
  const auto trend = trend_of(line(-0.06, 0.01, 24));
  ASSERT_TRUE(trend);
  EXPECT_GT(trend->std_per_year, 1e-3);
  EXPECT_NEAR(trend->slope_per_year, -0.06, 3.0 * trend->std_per_year);
}

TEST(Trend, TheLastYearCountsMost) {
  std::vector<GradeAt> grades;
  for (int k = 0; k < 24; ++k) grades.push_back({synthetic::month(k), k < 12 ? 0.9 : 0.9 - 0.01 * (k - 11)});
  const auto bent = trend_of(grades);
  double mean = 0.0, slope = 0.0, spread = 0.0;  // unweighted regression beside it
  for (const GradeAt& g : grades) mean += g.grade / 24.0;
  for (int k = 0; k < 24; ++k) {
    slope += (k - 11.5) / 12.0 * (grades[static_cast<std::size_t>(k)].grade - mean);
    spread += (k - 11.5) / 12.0 * (k - 11.5) / 12.0;
  }
  EXPECT_LT(bent->slope_per_year, slope / spread);
}

// By hand: a test a year, t = -5 .. 0 years, g = 0.9 0.9 0.9 0.8 0.9 0.6, w = e^t.
//   sum w = 1.578055, t_w = -0.567067, g_w = 0.701317, S = 1.311355, sum w (t - t_w)(g - g_w) = -0.150728
//   slope = -0.114940, sum r^2 = 0.169394, s^2 = 0.042348, std = 0.099751; with the memory of 3 months: slope -0.2857
TEST(Trend, ForgetsAndErrsAsComputedByHand) {
  const std::vector<double> by_year = {0.9, 0.9, 0.9, 0.8, 0.9, 0.6};
  std::vector<GradeAt> grades;
  for (const double one : by_year) grades.push_back({synthetic::month(12 * static_cast<int>(grades.size())), one});
  const auto trend = trend_of(grades);
  ASSERT_TRUE(trend);
  EXPECT_NEAR(trend->slope_per_year, -0.114940, 2e-6);
  EXPECT_NEAR(trend->std_per_year, 0.099751, 2e-6);
}

TEST(Trend, TooFewTestsHaveNone) {
  EXPECT_FALSE(trend_of(line(-0.06, 0.01, 5)));
  EXPECT_TRUE(trend_of(line(-0.06, 0.01, 6)));
  EXPECT_FALSE(trend_of(std::vector<GradeAt>(10, {synthetic::month(0), 0.5})));
}

}  // namespace
}  // namespace sealwatch

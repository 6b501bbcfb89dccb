// Which fit counts, and why a test is left out.
#include "services/prognostic_assessment/judge_estimate.hpp"

#include <gmock/gmock.h>

#include "tests/unit/layers/prognostic_assessment/fixtures.hpp"

namespace sealwatch::prognostic_assessment {
namespace {

using test::fit;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kLargestStd = 0.1;
const AssetConfig kAsset = test::configuration().assets[0];
const AssetConfig kAssetWithoutSeal = test::configuration().assets[1];

LeakageEstimate judge(std::vector<FitReport> fits, const test::TestCase& test = {}) {
  return judge_estimate(kAsset, test.health(), std::move(fits), kLargestStd);
}

TEST(JudgeEstimate, ThetaFollowsFromTheSealsLine) {
  // Half way between 4.64e12 (0.6) and 2.6e13 (1.0) is theta = 0.8; 1.068e11 is a hundredth of 0.5 % of the span:
  // 0.002.
  const LeakageEstimate estimate = judge({fit("eha", 1.532e13, 1.068e11)});
  EXPECT_TRUE(estimate.estimated && estimate.condition_known && estimate.used_for_forecast);
  EXPECT_NEAR(estimate.condition, 0.8, 1e-12);
  EXPECT_NEAR(estimate.condition_std, 0.002, 1e-12);
  EXPECT_EQ(estimate.chosen_model, "eha");
  EXPECT_TRUE(estimate.reasons.empty());
}

TEST(JudgeEstimate, TakesTheFirstAdmissibleFit) {
  const LeakageEstimate estimate = judge({fit("eha", 1e13, 1e11, false), fit("cylinder_circuit", 2e13, 1e11)});
  EXPECT_EQ(estimate.chosen_model, "cylinder_circuit");
  EXPECT_TRUE(estimate.used_for_forecast);
  EXPECT_EQ(estimate.fits.size(), 2u);
}

FitReport refused(double resistance, double std_error, bool converged) {
  FitReport report = fit("eha", resistance, std_error, false);
  report.converged = converged;
  return report;
}

TEST(JudgeEstimate, AFitThatEndedNearWhereItBeganIsNoEstimate) {
  for (const FitReport& bad : {refused(2.6e13, 1e11, false), refused(2.6e13, 4.7e13, true)}) {
    const LeakageEstimate estimate = judge({bad});
    EXPECT_FALSE(estimate.estimated || estimate.condition_known || estimate.used_for_forecast);
    EXPECT_THAT(estimate.reasons, ElementsAre("no fit gave an estimate of R_CL", HasSubstr("whiteness")));
  }
}

TEST(JudgeEstimate, BadlyFittedTestIsEstimatedMarkedAndLeftOut) {
  const LeakageEstimate estimate = judge({refused(1e13, 1e11, true)});
  EXPECT_TRUE(estimate.estimated);
  EXPECT_FALSE(estimate.used_for_forecast);
  EXPECT_THAT(estimate.reasons, ElementsAre(HasSubstr("whiteness")));
}

TEST(JudgeEstimate, InadmissibleTestKeepsItsEstimateAndItsReason) {
  const LeakageEstimate estimate = judge({fit("eha", 2e13, 1e11)}, {.admissible = false});
  EXPECT_TRUE(estimate.estimated);
  EXPECT_FALSE(estimate.used_for_forecast);
  EXPECT_THAT(estimate.reasons, ElementsAre("cut after 7.4 s of about 31 s"));
}

TEST(JudgeEstimate, NegativeResistanceIsLeftOut) {
  const LeakageEstimate estimate = judge({fit("eha", -2e13, 1e11)});
  EXPECT_FALSE(estimate.condition_known || estimate.used_for_forecast);
  EXPECT_THAT(estimate.reasons, ElementsAre(HasSubstr("is not positive")));
}

TEST(JudgeEstimate, NumbersThatAreNoneAreNoEstimate) {
  for (const FitReport& bad : {fit("eha", NAN, 1e11), fit("eha", 1e13, INFINITY)}) EXPECT_FALSE(judge({bad}).estimated);
  EXPECT_THAT(judge({}).reasons, ElementsAre(HasSubstr("no fit gave")));
  FitReport held = fit("eha", 1e13, 0.0);
  held.parameters[0].free = false;  // given, not estimated
  EXPECT_FALSE(judge({held}).estimated);
}

TEST(JudgeEstimate, VagueEstimateIsLeftOut) {
  const LeakageEstimate estimate = judge({fit("eha", 2e13, 6e12)});  // 0.11 of theta
  EXPECT_FALSE(estimate.used_for_forecast);
  EXPECT_THAT(estimate.reasons,
              ElementsAre(HasSubstr("standard error of the seal condition, 11.2 %, is above 10.0 %")));
}

TEST(JudgeEstimate, WithoutSealResistancesThereIsNoCondition) {
  const LeakageEstimate estimate =
      judge_estimate(kAssetWithoutSeal, test::TestCase{}.health(), {fit("eha_switched", 2e13, 1e11)}, kLargestStd);
  EXPECT_TRUE(estimate.estimated);
  EXPECT_FALSE(estimate.condition_known || estimate.used_for_forecast);
  EXPECT_THAT(estimate.reasons, Contains(HasSubstr("no seal resistances")));
}

TEST(JudgeEstimate, WithoutStartTimeThereIsNoPlaceInTheHistory) {
  const LeakageEstimate estimate = judge({fit("eha", 2e13, 1e11)}, {.time_known = false});
  EXPECT_TRUE(estimate.condition_known);
  EXPECT_FALSE(estimate.used_for_forecast);
  EXPECT_THAT(estimate.reasons, ElementsAre(HasSubstr("no start time")));
}

}  // namespace
}  // namespace sealwatch::prognostic_assessment

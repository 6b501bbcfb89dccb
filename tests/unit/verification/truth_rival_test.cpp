// What the strata about the limits of tests hide is hidden indeed: recomputed by the generator alone, whole sets.
#include "tests/unit/verification/truth_rival.hpp"

#include <gtest/gtest.h>

#include <set>

namespace sealwatch::bench {
namespace {

constexpr double kInTheNoise = 4.0;    // noncentrality: two standard deviations of a difference's own scatter
constexpr double kUnseen = 6.63;       // 1 % limit of chi-squared, one degree of freedom
constexpr double kPlainlySeen = 27.0;  // what the analysis sees with 80 % power (docs/mismatch.md, thresholds)

using Tests = std::vector<PlannedTrialTest>;

// One set of every pair. Tests to fit, all free parameters and the twin's size free.
void expect_inseparable(std::uint64_t seed) {
  const TrialPlan plan = plan_trial(TrialStratum::inseparable, seed);
  const auto alone = closest_rival(plan, plan.fit, {});
  const auto twin = closest_rival(plan, plan.fit, plan.twin_physics);
  ASSERT_TRUE(alone) << alone.error().describe();
  ASSERT_TRUE(twin) << twin.error().describe();
  EXPECT_GT(alone->distance, kPlainlySeen) << plan.label();
  EXPECT_LT(twin->distance, kInTheNoise) << plan.label() << ", twin " << plan.twin;
}

TEST(TruthRival, WhichChamberLeaksNobodySeesWithoutPressures) { expect_inseparable(104); }
TEST(TruthRival, OneSpeedAloneDoesNotTellThePumpFromTheSensor) { expect_inseparable(105); }

// The refitted model's distance on nominal tests, and what it then misses under other conditions.
void expect_swallowed(TrialStratum stratum, std::uint64_t seed) {
  const TrialPlan plan = plan_trial(stratum, seed);
  const TrialPlan wide = plan_trial(TrialStratum::concealed, seed);
  const Tests nominal = stratum == TrialStratum::concealed ? Tests{plan.fit[0], plan.fit[1]} : plan.fit;
  const Tests other = {wide.fit[2], wide.fit[3], wide.holdout[0], wide.holdout[1]};
  const auto model = closest_rival(plan, nominal, {}, other);
  ASSERT_TRUE(model) << model.error().describe();
  EXPECT_LT(model->distance, kUnseen) << plan.label();
  EXPECT_GT(model->elsewhere, kPlainlySeen) << plan.label();
}

TEST(TruthRival, NominalTestsDoNotShowASwallowedSlip) { expect_swallowed(TrialStratum::nominal_only, 104); }
TEST(TruthRival, NominalTestsOfAConcealedSetDoNotShowALine) { expect_swallowed(TrialStratum::concealed, 102); }

TEST(TruthRival, WhatShowsPlainlyIsFarFromTheModel) {  // so that a small distance means something
  TrialPlan plan = plan_trial(TrialStratum::inseparable, 105);
  plan.fit.resize(1);
  for (HiddenEffect& effect : plan.effects) effect.size *= 10.0;
  const auto model = closest_rival(plan, plan.fit, {});
  ASSERT_TRUE(model) << model.error().describe();
  EXPECT_GT(model->distance, kPlainlySeen);
}

TEST(TruthRival, TheTruthItselfIsNoDistanceAway) {
  TrialPlan plan = plan_trial(TrialStratum::inseparable, 105);
  plan.fit.resize(1);
  const auto itself = closest_rival(plan, plan.fit, {.effects = plan.effects, .faults = plan.faults});
  ASSERT_TRUE(itself) << itself.error().describe();
  EXPECT_LT(itself->distance, 1e-9);
}

TEST(Trials, EveryPairAndEverySwallowedEffectComesInTurn) {
  std::set<std::string> pairs, swallowed;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const TrialPlan pair = plan_trial(TrialStratum::inseparable, seed);
    ASSERT_EQ(pair.truths().size(), 1U);
    EXPECT_NE(pair.twin, pair.truths()[0].id + " " + pair.truths()[0].element) << pair.label();
    pairs.insert(pair.truths()[0].element + pair.twin);
    const TrialPlan nominal = plan_trial(TrialStratum::nominal_only, seed);
    ASSERT_EQ(nominal.truths().size(), 1U);
    swallowed.insert(nominal.truths()[0].id + nominal.truths()[0].element);
  }
  EXPECT_EQ(pairs.size(), 7U);  // two forms of leakage of chamber b have the same twin
  EXPECT_EQ(swallowed.size(), 10U);
}

}  // namespace
}  // namespace sealwatch::bench

#include "services/state_detection/indicators.hpp"

#include <gtest/gtest.h>

#include <map>

#include "sealwatch/config/judged_quantities.hpp"
#include "services/state_detection/judgements.hpp"
#include "services/state_detection/region.hpp"
#include "services/state_detection/rules.hpp"
#include "tests/unit/layers/state_detection/synthetic_test.hpp"

namespace sealwatch {
namespace {

/// Means over some hundred noisy samples: a few tenths of a percent.
constexpr double kNoise = 0.005;

std::map<std::string, double> indicators(const synthetic::Condition& condition,
                                         const synthetic::Circumstances& circumstances = {}) {
  const synthetic::Test test = synthetic::make(condition, circumstances);
  std::map<std::string, double> values;
  for (const Quantity& quantity : condition_indicators(synthetic::asset(), test.features, test.window))
    values[quantity.name] = quantity.value;
  return values;
}

TEST(Indicators, RecoverTheCoefficientsOfTheBalances) {
  auto values = indicators({});
  EXPECT_NEAR(values["pump_slip"] / 2e-14, 1.0, 20 * kNoise);  // a small difference of flows
  EXPECT_NEAR(values["shaft_drag"] / 1e-3, 1.0, kNoise);
  EXPECT_NEAR(values["back_emf"] / 0.2, 1.0, kNoise);
  EXPECT_NEAR(values["flow_gain"], 1.0, kNoise);
  EXPECT_NEAR(values["delivery_ratio"], 1.0, kNoise);
  EXPECT_NEAR(values["velocity_gain"], 1.0, kNoise);
  EXPECT_NEAR(values["closing_time"] / 60.15, 1.0, kNoise);
  EXPECT_NEAR(values["load_pressure"] / (6e4 / synthetic::kArea), 1.0, kNoise);
}

TEST(Indicators, TheLoadMovesOnlyTheLoad) {
  synthetic::Condition heavy;
  heavy.load_factor = 0.2;
  auto light_values = indicators({});
  auto heavy_values = indicators(heavy);
  EXPECT_NEAR(heavy_values["load_pressure"] / light_values["load_pressure"], 1.2, kNoise);
  for (const char* name : {"pump_slip", "shaft_drag", "back_emf", "flow_gain", "delivery_ratio", "velocity_gain",
                           "leakage_resistance", "friction_pressure", "closing_time"})
    EXPECT_NEAR(heavy_values[name] / light_values[name], 1.0, name == std::string("pump_slip") ? 20 * kNoise : kNoise)
        << name;
  EXPECT_NEAR(heavy_values["load_free_current"] / light_values["load_free_current"], 1.0,
              0.05);  // leakage grows with it
}

TEST(Indicators, LeakageDoesNotLookLikeAnythingElse) {
  synthetic::Condition worn;
  worn.theta = 0.62;
  auto healthy_values = indicators({});
  auto worn_values = indicators(worn);
  EXPECT_LT(worn_values["leakage_resistance"], 0.5 * healthy_values["leakage_resistance"]);
  for (const char* name : {"pump_slip", "shaft_drag", "back_emf", "flow_gain", "delivery_ratio"})
    EXPECT_NEAR(worn_values[name] / healthy_values[name], 1.0, name == std::string("pump_slip") ? 20 * kNoise : kNoise)
        << name;
}

TEST(Indicators, AbsentChannelsMakeThemAbsent) {
  synthetic::Circumstances circumstances;
  circumstances.failed_channel = "flow";
  const auto values = indicators({}, circumstances);
  EXPECT_EQ(values.count("flow_gain"), 0U);
  EXPECT_EQ(values.count("pump_slip"), 0U);
  EXPECT_EQ(values.count("leakage_resistance"), 0U);
  EXPECT_EQ(values.count("back_emf"), 1U);
  EXPECT_TRUE(condition_indicators(AssetConfig{}, TestFeatures{}, TestWindow{}).size() == 1);  // missing_share alone
}

TEST(Rules, SealLimitsFollowTheConditionThatIsLeft) {
  const AssetConfig asset = synthetic::asset();
  const auto limits = fixed_limits(asset, "leakage_resistance");
  ASSERT_TRUE(limits);
  EXPECT_NEAR(asset.condition->condition(limits->advisory), 0.70, 1e-12);
  EXPECT_NEAR(asset.condition->condition(limits->warning), 0.65, 1e-12);
  EXPECT_NEAR(asset.condition->condition(limits->alarm), 0.60, 1e-12);
  EXPECT_FALSE(baseline_rule(asset, "leakage_resistance"));
}

TEST(Rules, TheAssetsOwnLimitsComeFirst) {
  AssetConfig asset = synthetic::asset();
  asset.alert_limits["friction_pressure"] = {5e5, 6e5, 7e5};
  ASSERT_TRUE(fixed_limits(asset, "friction_pressure"));
  EXPECT_EQ(fixed_limits(asset, "friction_pressure")->warning, 6e5);
  EXPECT_FALSE(fixed_limits(synthetic::asset(), "friction_pressure"));
}

TEST(Rules, ALostChannelIsJudgedByTheAssetsOwnLimitsToo) {
  AssetConfig asset = synthetic::asset();
  const auto region = [&asset] {
    const auto judgements = judge_channels(asset, {}, {"flow"});
    EXPECT_EQ(judgements.size(), 1U);
    const RegionJudgement& j = judgements.at(0);
    return region_of(j.value, {j.advisory_limit, j.warning_limit, j.alarm_limit});
  };
  EXPECT_EQ(region(), AlertRegion::advisory);
  asset.alert_limits["channel.flow"] = {1.0, 1.0, 2.0};
  EXPECT_EQ(region(), AlertRegion::warning);
}

TEST(Indicators, AllThatATestGivesAreQuantitiesThatMayHaveLimits) {
  const synthetic::Test test = synthetic::make({}, {});
  for (const Quantity& quantity : condition_indicators(synthetic::asset(), test.features, test.window)) {
    const JudgedIndicator* const known = find_indicator(quantity.name);
    ASSERT_NE(known, nullptr) << quantity.name;
    EXPECT_EQ(known->unit, quantity.unit) << quantity.name;
  }
}

TEST(Rules, AColdTestIsOffTemperatureToo) {
  const AssetConfig asset = synthetic::asset();
  const Quantity cold{"fluid_temperature_deviation", "K", -7.0, false, 0.0};
  const auto judgements = judge_indicators(asset, {cold}, Baseline({6}));
  ASSERT_EQ(judgements.size(), 1U);
  const RegionJudgement& j = judgements.front();
  EXPECT_EQ(region_of(j.value, {j.advisory_limit, j.warning_limit, j.alarm_limit}), AlertRegion::warning);
}

}  // namespace
}  // namespace sealwatch

// What is found beside a law must be more than that law's own form may be off by.
#include "services/common/mismatch/remainder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "sealwatch/model/physics.hpp"
#include "services/common/mismatch/explain_input.hpp"
#include "services/common/mismatch/standard_errors.hpp"
#include "services/common/runtime/asset_file.hpp"
#include "tests/unit/mismatch/simulated_test.hpp"

namespace sealwatch::mismatch {
namespace {

FoundEffect found(const char* id, const char* element, double gain) {
  FoundEffect effect;
  effect.what.id = id;
  effect.what.element = element;
  effect.delta_bic = -gain;
  return effect;
}

bool may_be_form(const LawAt&, const LawAt&) { return false; }

TEST(Remainder, LittleBesideALawAtTheSameElementMayBeItsForm) {
  const std::vector<FoundEffect> effects{found("stribeck_friction", "piston", 1e6),
                                         found("quadratic_drag", "piston", 1.1e4)};
  const auto remainder = remainder_among(effects, effects[1].what, may_be_form);
  ASSERT_TRUE(remainder);
  EXPECT_EQ(remainder->law.id, "quadratic_drag");
  EXPECT_THAT(remainder->sentence, testing::HasSubstr("1.1 % of what it took"));
}

TEST(Remainder, LittleElsewhereMayBeItsForm) {
  const std::vector<FoundEffect> effects{found("sensor_lag", "sensor:flow", 90.0),
                                         found("driver_dead_time", "driver", 1e6)};
  const auto remainder = remainder_among(effects, effects[0].what, may_be_form);
  ASSERT_TRUE(remainder);
  EXPECT_EQ(remainder->law.element, "sensor:flow");
}

TEST(Remainder, MuchElsewhereIsAnEffectOfItsOwn) {
  const std::vector<FoundEffect> effects{found("stribeck_friction", "piston", 1e6),
                                         found("sensor_gain", "sensor:flow", 3e4)};
  EXPECT_FALSE(remainder_among(effects, effects[1].what, may_be_form));
}

TEST(Remainder, LittleElsewhereStaysWhereNoFormCouldDoIt) {
  const std::vector<FoundEffect> effects{found("driver_dead_time", "driver", 90.0),
                                         found("position_dependent_load", "piston", 1e6)};
  EXPECT_FALSE(remainder_among(effects, effects[0].what, [&](const LawAt& small, const LawAt& large) {
    return small.element == "driver" && large.element == "piston";
  }));
}

TEST(Remainder, TwoLawsOfOneElementThatBothTakeMuchAreTwo) {
  const std::vector<FoundEffect> effects{found("coulomb_friction", "piston", 1e4),
                                         found("quadratic_drag", "piston", 3e2)};
  EXPECT_FALSE(remainder_among(effects, effects[1].what, may_be_form));
}

TEST(Remainder, WhatCouldSitAnywhereIsNotClaimed) {
  std::vector<FoundEffect> effects{found("coulomb_friction", "piston", 1e4), found("sensor_lag", "sensor:flow", 5e3)};
  effects[1].same_elements = {"driver", "winding", "shaft"};
  const auto remainder = remainder_among(effects, effects[1].what, may_be_form);
  ASSERT_TRUE(remainder);
  EXPECT_THAT(remainder->sentence, testing::HasSubstr("no second law is claimed"));
}

FittedModel model_with(double misfit) {
  FittedModel model;
  model.misfit = misfit;
  model.residuals = 1e5;
  return model;
}

TEST(Remainder, BesideALawThatLeavesAFiveHundredthNoOtherIsLookedFor) {
  const FittedModel without = model_with(2.01e7), with = model_with(1.2e5);
  EXPECT_TRUE(leaves_its_form_at_most(without, with, 500.0));
  EXPECT_FALSE(leaves_its_form_at_most(without, model_with(1.6e5), 500.0)) << "0.3 %";
  EXPECT_FALSE(leaves_its_form_at_most(model_with(2e8), model_with(2.1e5), 500.0)) << "0.05 % of a gross misfit";
  EXPECT_FALSE(leaves_its_form_at_most(with, with, 500.0)) << "nothing was taken";
  EXPECT_EQ(left_beside(found("stribeck_friction", "piston", 0.0).what, share_left(without, with, 500.0)),
            "What is left beside Stribeck friction at the piston is 0.1 % of what it took, and may be its exact form.");
}

TEST(Remainder, ANoiseThatIsLessThanToldHidesNoSecondLaw) {
  const FittedModel without = model_with(1.02e5), with = model_with(9.99e4);
  EXPECT_FALSE(leaves_its_form_at_most(without, with, 200.0)) << "a law that takes a tenth of the first one's";
}

TEST(Remainder, ALawWhoseStrengthMayBeNothingIsNotClaimed) {
  const AssetConfig asset = load_asset(SEALWATCH_SOURCE_DIR "/config/assets/xt03-mv2.yaml").value();
  const Law& law = **find_law("external_leakage", {"G"});
  const auto fitted = [&](double strength) {
    const std::vector<Recording> tests{recording_of(with_law(asset, law, "chamber_a", std::vector{strength}), 1.0)};
    const AssetConfig free = with_law(asset, law, "chamber_a", std::vector{1.0e-14});
    auto model = std::make_shared<const FittedModel>(fit_model(free, data_of(tests), nullptr, 1).value());
    return Trial{{{&law, "chamber_a"}}, std::move(model)};
  };
  const PlantDescription* plant = find_plant(asset.model).value();
  const Resolution exact{.share = 0.0, .plant = plant}, coarse{.share = 20.0, .plant = plant};
  EXPECT_FALSE(not_told_from_zero(fitted(1.0e-13), exact));
  EXPECT_TRUE(not_told_from_zero(fitted(1.0e-13), coarse)) << "the simulation's own errors feign as much";
  const std::optional<NotTold> nothing = not_told_from_zero(fitted(0.0), exact);
  ASSERT_TRUE(nothing);
  EXPECT_EQ(nothing->slot, 0U);
  EXPECT_THAT(nothing->sentence, testing::HasSubstr("external leakage at chamber A"));
}

// k_f i |i| / (i_f + |i|) is k_f / i_f i |i| where i_f lies beyond all currents: neither can be told, their ratio can.
TEST(Remainder, ALawIsThereWhoseStrengthIsToldWithItsShapeOnly) {
  const AssetConfig asset = load_asset(SEALWATCH_SOURCE_DIR "/config/assets/xt03-mv2.yaml").value();
  const Law& law = **find_law("torque_saturation", {"k_f", "i_f"});
  const std::vector parameters{0.05, 60.0};
  const std::vector<Recording> tests{recording_of(with_law(asset, law, "shaft", parameters), 1.0)};
  auto model = std::make_shared<const FittedModel>(
      fit_model(with_law(asset, law, "shaft", parameters), data_of(tests), nullptr, 1).value());
  const auto strength = std::ranges::find(model->problem.shared, "shaft.torque_saturation.k_f", &Unknown::name);
  ASSERT_NE(strength, model->problem.shared.end());
  const auto place = static_cast<std::size_t>(strength - model->problem.shared.begin());
  const double error = standard_errors(*model)[place], value = model->asset.physics.back().parameters.at("k_f").value;
  ASSERT_TRUE(std::isfinite(error) && 2.0 * error > value) << value << " ± " << error << ": told by itself, too";
  const PlantDescription* plant = find_plant(asset.model).value();
  EXPECT_FALSE(not_told_from_zero(Trial{{{&law, "shaft"}}, std::move(model)}, {.share = 0.0, .plant = plant}));
}

TEST(TakesUpLittle, TellsByTheBestModelWhereThatMissesByLessThanTheDeclaredNoise) {
  FittedModel without, best, other;
  without.residuals = best.residuals = other.residuals = 1e4;
  without.misfit = 9855.0;
  best.misfit = 9757.0;
  other.misfit = 9818.0;
  EXPECT_FALSE(takes_up_little(without, best, best.misfit));
  EXPECT_TRUE(takes_up_little(without, other, best.misfit));
}

}  // namespace
}  // namespace sealwatch::mismatch

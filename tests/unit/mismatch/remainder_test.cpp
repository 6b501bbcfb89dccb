// What is found beside a law must be more than that law's own form may be off by.
#include "services/common/mismatch/remainder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sealwatch::mismatch {
namespace {

FoundEffect found(const char* id, const char* element, double gain) {
  FoundEffect effect;
  effect.what.id = id;
  effect.what.element = element;
  effect.delta_bic = -gain;
  return effect;
}

TEST(Remainder, LittleBesideALawAtTheSameElementMayBeItsForm) {
  const std::vector<FoundEffect> effects{found("stribeck_friction", "piston", 1e6),
                                         found("quadratic_drag", "piston", 1.1e4)};
  const auto remainder = remainder_among(effects, effects[1].what);
  ASSERT_TRUE(remainder);
  EXPECT_EQ(remainder->law.id, "quadratic_drag");
  EXPECT_THAT(remainder->sentence, testing::HasSubstr("1.1 % of what it took"));
}

TEST(Remainder, AsMuchElsewhereIsAnEffectOfItsOwn) {
  const std::vector<FoundEffect> effects{found("stribeck_friction", "piston", 1e6),
                                         found("sensor_gain", "sensor:flow", 9e3)};
  EXPECT_FALSE(remainder_among(effects, effects[1].what));
}

TEST(Remainder, AlmostNothingElsewhereMayBeItsForm) {
  const std::vector<FoundEffect> effects{found("sensor_lag", "sensor:flow", 90.0),
                                         found("driver_dead_time", "driver", 1e6)};
  const auto remainder = remainder_among(effects, effects[0].what);
  ASSERT_TRUE(remainder);
  EXPECT_EQ(remainder->law.element, "sensor:flow");
}

TEST(Remainder, TwoLawsOfOneElementThatBothTakeMuchAreTwo) {
  const std::vector<FoundEffect> effects{found("coulomb_friction", "piston", 1e4),
                                         found("quadratic_drag", "piston", 3e2)};
  EXPECT_FALSE(remainder_among(effects, effects[1].what));
}

TEST(Remainder, WhatCouldSitAnywhereIsNotClaimed) {
  std::vector<FoundEffect> effects{found("coulomb_friction", "piston", 1e4), found("sensor_lag", "sensor:flow", 5e3)};
  effects[1].same_elements = {"driver", "winding", "shaft"};
  const auto remainder = remainder_among(effects, effects[1].what);
  ASSERT_TRUE(remainder);
  EXPECT_THAT(remainder->sentence, testing::HasSubstr("no second law is claimed"));
}

}  // namespace
}  // namespace sealwatch::mismatch

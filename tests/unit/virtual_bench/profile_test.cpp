#include "services/virtual_bench/profile.hpp"

#include <gtest/gtest.h>

#include "services/virtual_bench/controller.hpp"

namespace sealwatch::bench {
namespace {

TEST(Profile, PstGoesOutHoldsAndComesBack) {
  const Profile profile = pst_profile({.start_m = 0.060, .stroke_m = -0.016, .speed_m_s = 0.001, .hold_s = 3.0});
  EXPECT_DOUBLE_EQ(profile.duration_s(), 1.0 + 16.0 + 3.0 + 16.0 + 3.0);
  EXPECT_DOUBLE_EQ(profile.reference_m(-5.0), 0.060);
  EXPECT_DOUBLE_EQ(profile.reference_m(1.0), 0.060);
  EXPECT_DOUBLE_EQ(profile.reference_m(9.0), 0.052);
  EXPECT_NEAR(profile.reference_m(18.5), 0.044, 1e-15);
  EXPECT_NEAR(profile.reference_m(28.0), 0.052, 1e-15);
  EXPECT_NEAR(profile.reference_m(100.0), 0.060, 1e-15);
}

TEST(Profile, MoveEndsAtItsTarget) {
  const Profile profile = move_profile(0.060, 0.0, 0.0015, TestKind::full_stroke);
  EXPECT_DOUBLE_EQ(profile.duration_s(), 1.0 + 40.0 + 3.0);
  EXPECT_NEAR(profile.reference_m(44.0), 0.0, 1e-15);
  EXPECT_EQ(profile.kind, TestKind::full_stroke);
}

TEST(Controller, LimitsSpeedAndVoltage) {
  const CascadeController controller{.setting = {}, .feed_forward_V_s_m = 29600.0, .ramp_speed_m_s = 1.33e-3};
  const double fastest = 1.6 * 1.33e-3;
  EXPECT_DOUBLE_EQ(controller(1.0, 0.0, 0.0, -50.0).voltage_V, 29600.0 * fastest + 4000.0 * fastest - 50.0);
  EXPECT_DOUBLE_EQ(controller(1.0, 0.0, 0.0, 0.0).voltage_V, 60.0);
  EXPECT_DOUBLE_EQ(controller(-1.0, 0.0, 0.0, 0.0).voltage_V, -60.0);
}

TEST(Controller, IntegralIsDrivenBackAtTheLimitOnly) {
  const CascadeController controller{.setting = {}, .feed_forward_V_s_m = 0.0, .ramp_speed_m_s = 1e-3};
  EXPECT_DOUBLE_EQ(controller(1e-4, 0.0, 0.0, 10.0).integral_rate_V_s, 8000.0 * 3e-4);
  EXPECT_LT(controller(1e-4, 0.0, 0.0, 70.0).integral_rate_V_s, -90.0);  // (60 - 71.2) V / 0.1 s, and 2.4 V/s upwards
}

}  // namespace
}  // namespace sealwatch::bench

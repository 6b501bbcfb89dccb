// Element laws: values where the physics is known, derivatives against central differences, at the rounded corners
// above all.
#include "sealwatch/model/laws.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace sealwatch {
namespace {

using One = Dual<1>;

/// Slope by dual numbers against a central difference over `step`.
template <class Law>
void expect_slope(const Law& law, double x, double step, double tolerance) {
  const double difference = (law(x + step) - law(x - step)) / (2.0 * step);
  const One dual = law(One::variable(x, 0));
  EXPECT_NEAR(dual.derivative[0], difference, tolerance * std::max(1.0, std::abs(difference))) << "at " << x;
  EXPECT_DOUBLE_EQ(dual.value, law(x)) << "at " << x;
}

constexpr double kDifferenceError = 1e-6;  // of the central differences below, relative

TEST(Laws, SmoothStepIsHalfAtZeroAndSaturatesWithoutOverflow) {
  EXPECT_DOUBLE_EQ(laws::smooth_step(0.0), 0.5);
  EXPECT_NEAR(laws::smooth_step(1.3), 0.5 * (1.0 + std::tanh(1.3)), 1e-15);
  EXPECT_EQ(laws::smooth_step(2000.0), 1.0);
  EXPECT_EQ(laws::smooth_step(-2000.0), 0.0);
  EXPECT_TRUE(std::isfinite(laws::smooth_step(One::variable(-2000.0, 0)).derivative[0]));
  for (const double a : {-3.0, -1e-3, 0.0, 1e-3, 3.0})
    expect_slope([](const auto& x) { return laws::smooth_step(x); }, a, 1e-5, kDifferenceError);
}

TEST(Laws, SmoothPositiveIsThePositivePartBeyondItsWidth) {
  constexpr double s = 2e4;
  EXPECT_NEAR(laws::smooth_positive(1e6, s), 1e6, 1e-9);
  EXPECT_NEAR(laws::smooth_positive(-1e6, s), 0.0, 1e-9);
  EXPECT_EQ(laws::smooth_positive(-1e9, s), 0.0);
  EXPECT_NEAR(laws::smooth_positive(0.0, s), s * std::log(2.0), 1e-9);
  for (const double a : {-1e5, -1e3, 0.0, 1e3, 1e5, 7.9e5, 8.1e5})
    expect_slope([](const auto& x) { return laws::smooth_positive(x, 2e4); }, a, 1.0, kDifferenceError);
}

TEST(Laws, SmoothAbsTouchesItsCorner) {
  EXPECT_EQ(laws::smooth_abs(0.0, 10.0), 0.0);
  EXPECT_NEAR(laws::smooth_abs(-1e6, 10.0), 1e6 - 10.0, 1e-3);
  for (const double a : {-20.0, 0.0, 5.0}) {
    expect_slope([](const auto& x) { return laws::smooth_abs(x, 10.0); }, a, 1e-4, kDifferenceError);
  }
}

TEST(Laws, OrificeIsTurbulentFarFromZeroLinearAtZeroAndOdd) {
  const auto flow = [](const auto& drop) { return laws::orifice_flow(0.6, 5e-6, 870.0, drop, 1e3); };
  EXPECT_NEAR(flow(1e7) / (0.6 * 5e-6 * std::sqrt(2.0 * 1e7 / 870.0)), 1.0, 1e-4);
  EXPECT_EQ(flow(0.0), 0.0);
  EXPECT_DOUBLE_EQ(flow(-3e5), -flow(3e5));
  const double slope_at_zero = 0.6 * 5e-6 * std::sqrt(2.0 / 870.0) / std::sqrt(1e3);
  EXPECT_NEAR(flow(One::variable(0.0, 0)).derivative[0], slope_at_zero, 1e-20);
  for (const double drop : {-1e6, -1e3, -1.0, 1.0, 1e3, 1e6}) {
    const double step = 1e-4 * std::abs(drop);
    const double difference = (flow(drop + step) - flow(drop - step)) / (2.0 * step);
    EXPECT_NEAR(flow(One::variable(drop, 0)).derivative[0] / difference, 1.0, kDifferenceError) << drop;
  }
}

TEST(Laws, MakeUpFlowFeedsOnlyBelowTheReservoirsPressure) {
  const auto flow = [](double pressure) { return laws::make_up_flow(1e-11, 1e6, pressure, 2e4); };
  EXPECT_NEAR(flow(0.5e6), 1e-11 * 0.5e6, 1e-12 * 0.5e6 * 1e-3);
  EXPECT_LT(flow(2e6), 1e-20);
  EXPECT_GE(flow(2e6), 0.0);
}

TEST(Laws, EndStopPushesBackAndDampsOnlyTheWayIn) {
  const auto force = [](double depth, double into) { return laws::end_stop_force(depth, into, 4e8, 1e6); };
  EXPECT_EQ(force(-1e-3, 0.01), 0.0);
  EXPECT_NEAR(force(1e-3, 0.0), 4e8 * 1e-3, 1.0);
  EXPECT_NEAR(force(1e-3, 0.01) - force(1e-3, 0.0), 1e6 * 0.01, 10.0);
  EXPECT_NEAR(force(1e-3, -0.01), force(1e-3, 0.0), 10.0);
  for (const double depth : {-1e-4, -1e-6, 0.0, 1e-6, 1e-4}) {
    const auto at_speed = [](const auto& d) { return laws::end_stop_force(d, 1e-3, 4e8, 1e6); };
    expect_slope(at_speed, depth, 1e-9, 1e-5);
    const auto at_depth = [depth](const auto& v) { return laws::end_stop_force(depth, v, 4e8, 1e6); };
    for (const double speed : {-1e-4, 0.0, 1e-4}) expect_slope(at_depth, speed, 1e-9, 1e-5);
  }
}

}  // namespace
}  // namespace sealwatch

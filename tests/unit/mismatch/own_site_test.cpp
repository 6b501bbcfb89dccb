// explain at a site of the plant's own kind, of which the catalogue knows nothing: the force of a voice coil.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "sealwatch/mismatch/explain.hpp"
#include "services/common/runtime/asset_file.hpp"
#include "services/common/runtime/plant_file.hpp"
#include "tests/unit/mismatch/cart_for_tests.hpp"
#include "tests/unit/model/recording_for_tests.hpp"

namespace sealwatch {
namespace {

constexpr const char* kCart = R"(name: cart_with_a_coil
meaning: cart on a spring that a voice coil pushes
inputs:
  current: {unit: A, course: held, range: [-10, 10], meaning: coil current}
outputs:
  position: {value: x, unit: m, noise_std: 2.0e-5, meaning: cart position}
parameters:
  m: {value: 2.0, unit: kg, tolerance: 0.01, meaning: cart}
  k: {value: 1100, unit: N/m, estimate: true, meaning: spring}
  c: {value: 4, min: 0.01, max: 100, unit: N s/m, estimate: true, meaning: damping}
  K: {value: 12, unit: N/A, tolerance: 0.02, meaning: force constant}
states:
  x: {der: v, unit: m, start: position}
  v: {der: (K*current - c*v - k*x - F - F_coil)/m, unit: m/s, start: rate(position), size: 0.1}
elements:
  cart:
    meaning: forces on the cart
    sites:
      - {kind: piston_force, symbol: F, signals: {speed: v, position: x}}
  coil:
    meaning: force of the coil
    sites:
      - kind: own
        unit: N
        size: 50
        symbol: F_coil
        signals: {current: {value: current, unit: A, size: 4}, gap: {value: x, unit: m, size: 0.05}}
law_sizes: {N: 0.003, m: 0.2, m/s: 50, N s/m: 1.0e-4, N s2/m2: 1.0e-6, N/m: 0.01, s: 1}
)";

/// What explain says of three rides of a cart, a fourth kept apart. `name`: of the plant.
Result<mismatch::Explanation> explained(const std::string& name, const CartTruth& truth) {
  std::string text = kCart;
  const std::string written = "cart_with_a_coil";
  text.replace(text.find(written), written.size(), name);
  const std::string file = ::testing::TempDir() + name + ".yaml";
  std::ofstream(file) << text;
  const auto plant = load_plant(file);
  if (!plant) return fail(combine(plant.error()));
  const std::vector<Recording> fit = {recorded_cart("first", truth, 1), recorded_cart("second", truth, 2),
                                      recorded_cart("third", truth, 3)};
  return mismatch::explain(nominal_asset((*plant)->name), fit, std::vector{recorded_cart("apart", truth, 4)});
}

/// k (current / 4 A) (gap / 50 mm)^2 = 12.1 N/A * 0.002 (gap / 10 mm)^2 current where k = 12.1 * 4 * 0.002 * 25 N.
TEST(OwnSite, AForceThatFallsWithStrokeIsFoundAtTheCoil) {
  const auto found = explained("cart_with_a_coil", {.fades_by = 0.002});
  ASSERT_TRUE(found) << found.error().describe();
  ASSERT_EQ(found->verdict, MismatchVerdict::mismatch) << found->summary;
  ASSERT_EQ(found->effects.size(), 1U) << found->summary;
  EXPECT_EQ(found->effects[0].what.element, "coil") << found->summary;
  ASSERT_EQ(found->effects[0].parameters.size(), 2U);
  EXPECT_EQ(found->effects[0].parameters[0].name, "k_current");
  EXPECT_NEAR(found->effects[0].parameters[0].value, 2.42, 0.05);
  EXPECT_EQ(found->effects[0].parameters[1].name, "b_gap");
  EXPECT_NEAR(found->effects[0].parameters[1].value, 2.0, 0.1);
}

/// At the site of the catalogue's kind, in the cart's sizes: 50 mm/s where the catalogue's actuator has 1 mm/s.
TEST(OwnSite, ADragByTheCubeOfSpeedIsMeasuredBySpeedsOfTheCart) {
  const auto found = explained("cart_with_cubic_drag", {.cubic_drag_N_s3_m3 = 400.0});
  ASSERT_TRUE(found) << found.error().describe();
  ASSERT_EQ(found->verdict, MismatchVerdict::mismatch) << found->summary;
  ASSERT_EQ(found->effects.size(), 1U) << found->summary;
  EXPECT_EQ(found->effects[0].what.form, "speed_power") << found->summary;
  EXPECT_NE(found->effects[0].what.law.find("abs(v / 0.05 m/s)^a_v"), std::string::npos) << found->effects[0].what.law;
  ASSERT_EQ(found->effects[0].parameters.size(), 2U);
  EXPECT_NEAR(found->effects[0].parameters[0].value, 400.0 * std::pow(0.05, 3), 0.1 * 400.0 * std::pow(0.05, 3));
  EXPECT_NEAR(found->effects[0].parameters[1].value, 3.0, 0.15);
}

}  // namespace
}  // namespace sealwatch

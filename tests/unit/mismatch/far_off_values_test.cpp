// explain where a model's values are far off: a cart on a spring that a voice coil pushes, its spring a hundred times
// stiffer in the plant's file than on the bench, or its sizes of laws a hundred times too large.
#include <gtest/gtest.h>

#include <algorithm>
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

struct CartFile {
  std::string force_constant = "12, unit: N/A, tolerance: 0.02";
  double window_s = 0.0;
};

std::string cart(const std::string& name, const std::string& spring, const std::string& newton, const CartFile& file) {
  return "name: " + name +
         "\n"
         "meaning: cart on a spring that a voice coil pushes\n"
         "inputs:\n"
         "  current: {unit: A, course: held, role: drive, range: [-10, 10], meaning: coil current}\n"
         "outputs:\n"
         "  position: {value: x, unit: m, noise_std: 2.0e-5, meaning: cart position}\n"
         "parameters:\n"
         "  m: {value: 2.0, unit: kg, tolerance: 0.01, meaning: cart}\n"
         "  k: {" +
         spring +
         ", unit: N/m, estimate: true, meaning: spring}\n"
         "  c: {value: 4, min: 0.01, max: 100, unit: N s/m, estimate: true, meaning: damping}\n"
         "  K: {value: " +
         file.force_constant +
         ", meaning: force constant}\n"
         "states:\n"
         "  x: {der: v, unit: m, start: position}\n"
         "  v: {der: (K*current - c*v - k*x - F)/m, unit: m/s, start: rate(position), size: 0.1}\n"
         "elements:\n"
         "  cart:\n"
         "    meaning: forces on the cart\n"
         "    sites:\n"
         "      - {kind: piston_force, symbol: F, signals: {speed: v, position: x}}\n"
         "law_sizes: {N: " +
         newton + ", m: 0.01, m/s: 0.2, N s/m: 0.5, N s2/m2: 5.0, N/m: 100, s: 1}\n" +
         (file.window_s > 0.0 ? "window_s: " + std::to_string(file.window_s) + "\n" : "");
}

// `spring`, `newton`: what the plant's file says of them.
mismatch::Explanation explained(const std::string& name, const std::string& spring, const std::string& newton,
                                const CartTruth& truth, const CartFile& plant_file = {}) {
  const std::string file = ::testing::TempDir() + name + ".yaml";
  std::ofstream(file) << cart(name, spring, newton, plant_file);
  const auto plant = load_plant(file);
  if (!plant) throw std::runtime_error(combine(plant.error()).describe());
  const std::vector<Recording> fit = {recorded_cart("first", truth, 1), recorded_cart("second", truth, 2),
                                      recorded_cart("third", truth, 3)};
  const auto found =
      mismatch::explain(nominal_asset((*plant)->name), fit, std::vector{recorded_cart("apart", truth, 4)});
  if (!found) throw std::runtime_error(found.error().describe());
  return *found;
}

void expect_friction(const mismatch::Explanation& found, double friction_N) {
  ASSERT_EQ(found.verdict, MismatchVerdict::mismatch) << found.summary;
  ASSERT_EQ(found.effects.size(), 1U) << found.summary;
  EXPECT_EQ(found.effects[0].what.id, "coulomb_friction") << found.summary;
  const mismatch::FoundParameter& strength = found.effects[0].parameters.at(0);
  EXPECT_NEAR(strength.value, friction_N, 0.05 * friction_N);
  EXPECT_LT(strength.std_error, 0.05 * friction_N) << "no better known than a hundredth of a size that is far off";
}

/// By a size of 180 N for what matters, 1.5 N were nothing; but the recording shows them 150 times its noise.
TEST(FarOffValues, ALawThatTheRecordingShowsPlainlyIsFoundBesideSizesThatAreFarOff) {
  expect_friction(explained("sizes", "value: 3000", "0.3", {.friction_N = 1.5}), 1.5);
}

/// The free run of a spring a hundred times too stiff hardly moves, whichever way its values change.
TEST(FarOffValues, AFitGoesOnFromTheRecordedStatesWhereItEndedInALocalMinimum) {
  const mismatch::Explanation found =
      explained("valley", "value: 3000, min: 1, max: 1.0e6", "0.003", {.spring_N_m = 31.0});
  EXPECT_EQ(found.verdict, MismatchVerdict::consistent) << found.summary;
  const auto tells = [](const std::string& note) { return note.starts_with("No range is given"); };
  EXPECT_TRUE(std::ranges::none_of(found.notes, tells)) << "both are, by powers of ten";
}

TEST(FarOffValues, AFitGoesBeyondARangeThatNobodyGave) {
  const mismatch::Explanation found = explained("range", "value: 3000", "0.003", {.spring_N_m = 31.0});
  EXPECT_EQ(found.verdict, MismatchVerdict::consistent) << found.summary;
  const auto tells = [](const std::string& note) { return note.starts_with("No range is given for k"); };
  EXPECT_TRUE(std::ranges::any_of(found.notes, tells));
}

/// The gain of the current and a force constant 6 % off do the same: as in a free run, neither is claimed.
TEST(FarOffValues, InWindowsAWrongValueIsNamedBesideAGainThatDoesTheSame) {
  const mismatch::Explanation found = explained(
      "windows", "value: 1000", "0.003", {}, {.force_constant = "11.3, unit: N/A, tolerance: 0.005", .window_s = 1.0});
  EXPECT_EQ(found.verdict, MismatchVerdict::undetermined) << found.summary;
  EXPECT_TRUE(found.effects.empty()) << found.summary;
  ASSERT_FALSE(found.asset_values.empty()) << found.summary;
  EXPECT_EQ(found.asset_values.front().front().name, "K");
  EXPECT_NEAR(found.asset_values.front().front().fitted, 12.1, 0.1);
}

TEST(FarOffValues, PhysicsIsFoundBesideThem) {
  expect_friction(explained("beside", "value: 3000", "0.003", {.spring_N_m = 31.0, .friction_N = 1.5}), 1.5);
}

}  // namespace
}  // namespace sealwatch

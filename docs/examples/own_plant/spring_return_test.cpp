// The plant of docs/reference/plant-in-cpp.md against the whole of sealwatch: an asset file, recordings made by other code with
// dry friction that the model lacks, and the analysis that has to find it.
#include "docs/examples/own_plant/spring_return.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include "sealwatch/mismatch/explain.hpp"
#include "services/common/runtime/asset_file.hpp"

namespace sealwatch::example {
namespace {

constexpr double kFriction_N = 60.0;

const PlantDescription& plant() {
  static const bool added = add_plant<SpringReturnModel>(describe_spring_return()).has_value();
  EXPECT_TRUE(added);
  return **find_plant("spring_return");
}

AssetConfig asset() {
  static_cast<void>(plant());
  const auto file = std::filesystem::path(testing::TempDir()) / "spring_return.yaml";
  std::ofstream(file) << "asset_id: V-7\nmodel: spring_return\n"
                         "parameters:\n"
                         "  M: {value: 20.0, min: 2.0, max: 200.0, estimate: true}\n"
                         "  F_v: {value: 2.0e3, min: 200.0, max: 2.0e4, estimate: true}\n"
                         "  k_s: {value: 1.0e4, min: 1.0e3, max: 1.0e5, estimate: true}\n";
  const auto loaded = load_asset(file.string());
  EXPECT_TRUE(loaded) << loaded.error().describe();
  return *loaded;
}

/// Strokes at different speeds, by explicit Euler steps of 5 us: other code than the simulation's.
Recording stroke(const std::string& name, double period_s, double friction_N, unsigned seed) {
  constexpr double kStep_s = 5e-6, kSample_s = 0.01, kDuration_s = 12.0, kPi = 3.141592653589793;
  constexpr double kMass = 23.0, kViscous = 1.7e3, kStiffness = 1.1e4, kForcePerVolt = 100.0, kReversal = 1e-3;
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 1e-5);
  Recording recording;
  recording.recording_id = name;
  recording.asset_id = "V-7";
  Series voltage{"drive_voltage", "V", 0.0, {}}, position{"position", "m", 0.0, {}};
  const auto command = [&](double t) { return 4.0 * (1.0 - std::cos(2.0 * kPi * t / period_s)); };
  const int steps_a_sample = static_cast<int>(std::lround(kSample_s / kStep_s));
  double x = 0.0, v = 0.0;
  for (int sample = 0; sample * kSample_s <= kDuration_s; ++sample) {
    recording.samples.time_s.push_back(sample * kSample_s);
    voltage.values.push_back(command(sample * kSample_s));
    position.values.push_back(x + noise(random));
    for (int k = 0; k < steps_a_sample; ++k) {
      const double t = sample * kSample_s + k * kStep_s;
      const double force =
          kForcePerVolt * command(t) - kViscous * v - kStiffness * x - friction_N * std::tanh(v / kReversal);
      v += kStep_s * force / kMass;
      x += kStep_s * v;
    }
  }
  recording.samples.channels = {std::move(voltage), std::move(position)};
  return recording;
}

std::vector<Recording> strokes(double friction_N) {
  return {stroke("slow", 6.0, friction_N, 1), stroke("fast", 2.5, friction_N, 2)};
}

TEST(OwnPlant, IsKnownByNameAndOnlyOnce) {
  EXPECT_EQ(plant().find_parameter("k_s")->unit, "N/m");
  EXPECT_FALSE(add_plant<SpringReturnModel>(describe_spring_return())) << "its name is taken";
}

TEST(OwnPlant, AForgottenSizeIsNamed) {
  PlantDescription small = describe_spring_return();
  small.name = "spring_return_without_a_size";
  std::erase_if(small.law_sizes, [](const LawSize& size) { return size.unit == "N/m"; });
  const Status added = add_plant<SpringReturnModel>(small);
  ASSERT_FALSE(added);
  EXPECT_NE(added.error().describe().find("'N/m': is missing"), std::string::npos) << added.error().describe();
}

TEST(OwnPlant, IsConsistentWithRecordingsThatLackNothing) {
  const auto found = mismatch::explain(asset(), strokes(0.0), std::vector{stroke("between", 4.0, 0.0, 3)});
  ASSERT_TRUE(found) << found.error().describe();
  EXPECT_EQ(found->verdict, MismatchVerdict::consistent) << found->summary;
  EXPECT_TRUE(found->effects.empty());
}

TEST(OwnPlant, FindsTheFrictionThatItsModelLacks) {
  const auto found =
      mismatch::explain(asset(), strokes(kFriction_N), std::vector{stroke("between", 4.0, kFriction_N, 3)});
  ASSERT_TRUE(found) << found.error().describe();
  ASSERT_EQ(found->verdict, MismatchVerdict::mismatch) << found->summary;
  EXPECT_EQ(found->location.at(0).element, "piston");
  const mismatch::FoundEffect& effect = found->effects.at(0);
  const auto is_coulomb = [](const mismatch::LawAt& law) { return law.id == "coulomb_friction"; };
  EXPECT_TRUE(is_coulomb(effect.what) || std::ranges::any_of(effect.indistinguishable, is_coulomb)) << effect.what.id;
  EXPECT_NEAR(effect.parameters.at(0).value, kFriction_N, 0.05 * kFriction_N);
  EXPECT_LT(found->holdout.channels.at(0).rms_after, 1.2);
  EXPECT_GT(found->holdout.channels.at(0).rms_before, 3.0);
}

}  // namespace
}  // namespace sealwatch::example

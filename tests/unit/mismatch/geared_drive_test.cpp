// explain and fit on a drive with a gear, written as text, whose law sizes are a user's guess: the same law is a hundred
// times as strong behind the gear, and a search sets out far from its scale.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>

#include "sealwatch/estimation/actuator_fit.hpp"
#include "sealwatch/mismatch/explain.hpp"
#include "services/common/runtime/asset_file.hpp"
#include "services/common/runtime/plant_file.hpp"
#include "tests/unit/model/recording_for_tests.hpp"

namespace sealwatch {
namespace {

constexpr const char* kWinch = R"yaml(name: winch
meaning: hydraulic motor, gearbox, elastic shaft, drum
inputs: {torque: {unit: N m, meaning: torque of the hydraulic motor}}
outputs:
  motor_speed: {value: w_m, unit: rad/s, noise_std: 0.3, meaning: speed of the motor}
  drum_speed:  {value: w_l, unit: rad/s, noise_std: 0.05, meaning: speed of the drum}
parameters:
  n:   {value: 5, unit: 1, meaning: gear ratio}
  J_m: {value: 0.01, unit: kg m2, meaning: inertia of the motor}
  J_l: {value: 1.8, unit: kg m2, meaning: inertia of the drum, estimate: true}
  k:   {value: 700, unit: N m/rad, meaning: stiffness of the shaft, estimate: true}
  c:   {value: 2.0, unit: N m s/rad, meaning: damping of the shaft, estimate: true}
  d_m: {value: 0.01, unit: N m s/rad, meaning: viscous friction of the motor, estimate: true}
  d_l: {value: 1.0, unit: N m s/rad, meaning: viscous friction of the drum, estimate: true}
definitions:
  slip: w_m/n - w_l
  T_s: k*phi + c*slip
states:
  w_m: {der: (torque - d_m*w_m - T_s/n - T_motor)/J_m, unit: rad/s, start: motor_speed}
  phi: {der: slip, unit: rad, start: "0[rad]", size: 0.02}
  w_l: {der: (T_s - d_l*w_l - T_drum)/J_l, unit: rad/s, start: drum_speed}
elements:
  motor:
    meaning: motor shaft
    sites: [{kind: shaft_torque, symbol: T_motor, signals: {speed: w_m}}]
  drum:
    meaning: drum shaft
    sites: [{kind: shaft_torque, symbol: T_drum, signals: {speed: w_l}}]
law_sizes: {N m: 1, N m s/rad: 1, m3/rad: 1, rad/s: 1}
)yaml";

constexpr double kDrag_N_m = 400.0;  // of the drum at 100 rad/s, growing with the square of its speed

// Steps of torque, each reached within 50 ms; explicit Euler steps of 20 us: other code than the simulation's.
Recording winding(const std::string& name, unsigned seed) {
  constexpr double kStep_s = 2e-5, kSample_s = 0.02, kDuration_s = 16.0, kRamp_s = 0.05;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> level(-6.0, 10.0), lasts(0.8, 3.0);
  std::normal_distribution<double> noise(0.0, 1.0);
  Recording recording;
  recording.recording_id = name;
  Series torque{"torque", "N m", 0.0, {}}, motor{"motor_speed", "rad/s", 0.0, {}}, drum{"drum_speed", "rad/s", 0.0, {}};
  double from = 0.0, to = 0.0, since_s = 0.0, until_s = 0.5, w_m = 0.0, phi = 0.0, w_l = 0.0;
  for (int sample = 0; sample * kSample_s <= kDuration_s; ++sample) {
    const double t = sample * kSample_s;
    if (t >= until_s) {
      from = to;
      to = level(random);
      since_s = t;
      until_s = t + lasts(random);
    }
    const auto torque_at = [&](double at) { return from + (to - from) * std::min(1.0, (at - since_s) / kRamp_s); };
    recording.samples.time_s.push_back(t);
    torque.values.push_back(torque_at(t));
    motor.values.push_back(w_m + 0.3 * noise(random));
    drum.values.push_back(w_l + 0.05 * noise(random));
    for (int k = 0; k < static_cast<int>(std::lround(kSample_s / kStep_s)); ++k) {
      // Between samples the record is a straight line, as the simulation takes it.
      const double u = torque_at(t) + (torque_at(t + kSample_s) - torque_at(t)) * k * kStep_s / kSample_s;
      const double slip = w_m / 5.0 - w_l, shaft = 800.0 * phi + 2.0 * slip;
      const double drag = kDrag_N_m * w_l * std::abs(w_l) / 1e4;
      w_m += kStep_s * (u - 0.012 * w_m - shaft / 5.0) / 0.01;
      w_l += kStep_s * (shaft - 0.9 * w_l - drag) / 2.0;
      phi += kStep_s * slip;
    }
  }
  recording.samples.channels = {std::move(torque), std::move(motor), std::move(drum)};
  return recording;
}

AssetConfig winch() {
  const std::string file = ::testing::TempDir() + "winch.yaml";
  std::ofstream(file) << kWinch;
  const auto plant = load_plant(file);
  if (!plant) ADD_FAILURE() << combine(plant.error()).describe();
  return nominal_asset("winch");
}

/// The strength sets out at ten thousand times the size that its unit is said to have here.
TEST(GearedDrive, AStrengthFarFromItsScaleIsFitted) {
  AssetConfig asset = winch();
  asset.physics.push_back({.id = "unlisted",
                           .element = "drum",
                           .parameters = {{"T_w", {100.0, 0.0, 1e4, true}}, {"a_w", {1.5, 0.2, 5.0, true}}}});
  const std::vector<TimeSeries> recordings = {winding("one", 1).samples, winding("two", 2).samples};
  const JointFit fit = fit_actuator(asset, recordings, {});
  ASSERT_TRUE(fit.report.converged) << fit.report.termination;
  const auto fitted = [&](std::string_view name) {
    const auto found = std::ranges::find(fit.report.parameters, name, &EstimatedParameter::name);
    return found == fit.report.parameters.end() ? 0.0 : found->value;
  };
  EXPECT_NEAR(fitted("drum.unlisted.T_w"), kDrag_N_m, 0.1 * kDrag_N_m);
  EXPECT_NEAR(fitted("drum.unlisted.a_w"), 2.0, 0.1);
  for (const ChannelFit& channel : fit.report.channels) EXPECT_LT(channel.noise_normalised_rms, 1.2) << channel.channel;
}

/// The motor turns with the drum: its own drag does as well, and neither is certain.
TEST(GearedDrive, TheSameLawBehindTheGearIsAskedWithItsOwnStrength) {
  const auto found = mismatch::explain(winch(), std::vector{winding("one", 1), winding("two", 2), winding("three", 3)},
                                       std::vector{winding("four", 4)});
  ASSERT_TRUE(found) << found.error().describe();
  ASSERT_EQ(found->verdict, MismatchVerdict::mismatch) << found->summary;
  ASSERT_EQ(found->effects.size(), 1U) << found->summary;
  const mismatch::FoundEffect& drag = found->effects.front();
  EXPECT_TRUE(drag.what.element == "drum" || std::ranges::find(drag.same_elements, "drum") != drag.same_elements.end())
      << found->summary;
}

}  // namespace
}  // namespace sealwatch

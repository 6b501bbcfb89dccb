// A test on the bench as a whole: what physics and controller must give, and reproducibility.
#include "services/virtual_bench/simulate_test.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/virtual_bench/nominal.hpp"

namespace sealwatch::bench {
namespace {

using ::testing::HasSubstr;

// Times of the default test: rest to 1 s, out to 13 s, hold to 16 s, back to 28 s, hold to 31 s.
constexpr double kPistonArea_m2 = 5.89e-3;
constexpr double kLoad_N = 6.0e4;

TEST(SimulateTest, SameSeedGivesTheSameBits) {
  const Recording first = run(nominal_asset()), second = run(nominal_asset());
  EXPECT_EQ(first.samples, second.samples);
  EXPECT_NE(run(nominal_asset(), {}, {.seed = 2}).samples, first.samples);
}

TEST(SimulateTest, LeavingAChannelOutDoesNotChangeTheOthers) {
  const Recording all = run(nominal_asset());
  const Recording few = run(nominal_asset(), {}, {.channels = {"position", "flow"}});
  ASSERT_EQ(few.samples.channels.size(), 2U);
  // The set of low-passes changes the integrator's steps: equal within ten times its tolerance, far below the noise.
  for (const char* channel : {"position", "flow"})
    for (std::size_t k = 0; k < all.samples.time_s.size(); ++k)
      ASSERT_NEAR(few.samples.find(channel)->values[k], all.samples.find(channel)->values[k],
                  0.02 * all.samples.find(channel)->noise_std);
}

TEST(SimulateTest, RecordsTheWholeProfileAtTheSampleRate) {
  const Recording recording = run(nominal_asset(), {}, {.sample_rate_Hz = 50.0});
  const double duration_s = pst_profile({}).duration_s();
  EXPECT_EQ(recording.samples.time_s.front(), 0.0);
  EXPECT_NEAR(recording.samples.time_s.back(), duration_s, 1.0 / 50.0);
  EXPECT_EQ(recording.samples.time_s.size(), static_cast<std::size_t>(duration_s * 50.0) + 1);
  EXPECT_EQ(recording.samples.find("pressure_a")->unit, "Pa");
  EXPECT_EQ(recording.samples.find("pressure_a")->noise_std, 1e4);
}

TEST(SimulateTest, PistonFollowsTheReference) {
  const Recording recording = run(quiet_asset());
  EXPECT_NEAR(mean(between(recording, "velocity", 6.0, 12.0)), -1.33e-3, 1e-5);
  EXPECT_NEAR(mean(between(recording, "velocity", 20.0, 27.0)), 1.33e-3, 2e-5);
  EXPECT_NEAR(recording.samples.find("position")->values.front(), 0.060, 5e-5);
  EXPECT_NEAR(mean(between(recording, "position", 15.5, 16.0)), 0.044, 5e-5);
  EXPECT_NEAR(recording.samples.find("position")->values.back(), 0.060, 5e-5);
  const auto moving = between(recording, "velocity", 0.0, 40.0);
  EXPECT_GT(*std::min_element(moving.begin(), moving.end()), -1.6 * 1.33e-3);  // speed limit of the cascade
}

TEST(SimulateTest, PressuresCarryTheLoad) {
  for (const double load_factor : {-0.2, 0.0, 0.2}) {
    const Recording recording = run(quiet_asset(), {.load_factor = load_factor});
    const double drop =
        mean(between(recording, "pressure_a", 15.0, 16.0)) - mean(between(recording, "pressure_b", 15.0, 16.0));
    // Creep at the end of the hold, 1 um/s, times f_C of 2e6 N s/m is 2 N of 6e4; 1e-3 allows thirty times that.
    EXPECT_NEAR(kPistonArea_m2 * drop, kLoad_N * (1.0 + load_factor), 1e-3 * kLoad_N) << load_factor;
  }
}

TEST(SimulateTest, HoldFlowFeedsTheSealLeakage) {
  for (const double resistance : {2.6e13, 4.64e12}) {
    const Recording recording = run(quiet_asset(), {.parameters = {{"R_CL", resistance}}});
    const double drop = kLoad_N / kPistonArea_m2;
    // At rest the flow into chamber A leaks past the seal; creep of 2 um/s would add 1.2e-8 m3/s.
    EXPECT_NEAR(mean(between(recording, "flow", 0.5, 1.0)), drop / resistance, 6e-8) << resistance;
  }
}

TEST(SimulateTest, MotorCarriesPumpAndLosses) {
  const Recording recording = run(quiet_asset());
  const double speed = mean(between(recording, "shaft_speed", 20.0, 27.0));
  const double current = mean(between(recording, "motor_current", 20.0, 27.0));
  const double voltage = mean(between(recording, "motor_voltage", 20.0, 27.0));
  EXPECT_NEAR(voltage, 0.5 * current + 0.20 * speed, 0.01 * voltage);  // winding: u = R_M i + Omega_M omega
  // Pump: alpha_P omega covers the piston's A_C v and both leakages.
  const double drop =
      mean(between(recording, "pressure_a", 20.0, 27.0)) - mean(between(recording, "pressure_b", 20.0, 27.0));
  EXPECT_NEAR(3.98e-8 * speed, kPistonArea_m2 * 1.33e-3 + drop / 2.6e13 + drop / 5e13, 0.02 * 3.98e-8 * speed);
}

TEST(SimulateTest, AWornSealAsksForMoreSpeedToHold) {
  const double fresh = mean(between(run(quiet_asset()), "shaft_speed", 15.0, 16.0));
  const double worn = mean(between(run(quiet_asset(), {.parameters = {{"R_CL", 4.64e12}}}), "shaft_speed", 15.0, 16.0));
  const double leakage_difference = kLoad_N / kPistonArea_m2 * (1.0 / 4.64e12 - 1.0 / 2.6e13);
  EXPECT_NEAR(worn - fresh, leakage_difference / 3.98e-8, 0.1 * (worn - fresh));
}

TEST(SimulateTest, VoltageStaysWithinItsLimit) {
  AssetConfig asset = quiet_asset();
  asset.pst.speed_m_s = 5e-3;  // more than 60 V can do
  const Recording recording = run(asset);
  const std::vector<double>& voltage = recording.samples.find("motor_voltage")->values;
  EXPECT_EQ(*std::min_element(voltage.begin(), voltage.end()), -60.0);
  EXPECT_EQ(*std::max_element(voltage.begin(), voltage.end()), 60.0);
}

TEST(SimulateTest, NoiseComesOnTopOfTheQuietSignals) {
  const Recording quiet = run(quiet_asset()), noisy = run(nominal_asset());
  for (const Series& channel : noisy.samples.channels) {
    std::vector<double> error = channel.values;
    for (std::size_t k = 0; k < error.size(); ++k) error[k] -= quiet.samples.find(channel.name)->values[k];
    // The spread of 6200 samples scatters by 0.9 %.
    EXPECT_NEAR(standard_deviation(error), channel.noise_std, 0.04 * channel.noise_std) << channel.name;
  }
}

TEST(SimulateTest, BadInputIsAnError) {
  const auto error_of = [](const AssetConfig& asset, const TestConditions& conditions, const TestSetting& setting) {
    const auto result = simulate_test(asset, pst_profile(asset.pst), conditions, setting);
    return result ? std::string("accepted") : result.error().describe();
  };
  AssetConfig other = nominal_asset();
  other.model = "emps";
  EXPECT_THAT(error_of(other, {}, {}), HasSubstr("'emps': is not a plant of the virtual bench"));
  EXPECT_THAT(error_of(nominal_asset(), {.parameters = {{"R_LC", 1e13}}}, {}), HasSubstr("did you mean 'R_CL'?"));
  EXPECT_THAT(error_of(nominal_asset(), {.parameters = {{"R_CL", -1.0}}}, {}), HasSubstr("parameter R_CL"));
  EXPECT_THAT(error_of(nominal_asset(), {}, {.sample_rate_Hz = 0.0}), HasSubstr("sample rate"));
  AssetConfig far = nominal_asset();
  far.pst.stroke_m = -0.07;
  EXPECT_THAT(error_of(far, {}, {}), HasSubstr("leaves the stroke"));
}

}  // namespace
}  // namespace sealwatch::bench

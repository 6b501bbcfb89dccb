// Plants `emps` and `cascaded_tanks`: the fit finds what a recording was made with, and says of the real recordings how
// far their naive models are off. Skipped, saying so, where the real ones are absent.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "sealwatch/estimation/actuator_fit.hpp"
#include "sealwatch/model/eha_switched.hpp"
#include "services/common/model/plants/eha_switched/estimation/closed_valves.hpp"
#include "tests/unit/estimation/recordings.hpp"

namespace sealwatch {
namespace {

const EstimatedParameter& parameter(const FitReport& report, const std::string& name) {
  for (const EstimatedParameter& candidate : report.parameters)
    if (candidate.name == name) return candidate;
  throw std::out_of_range(name);
}

double rms_error(const TimeSeries& recorded, const RecordingFit& fit, const std::string& channel) {
  const std::vector<double>&measured = recorded.find(channel)->values, &simulated = fit.simulated.find(channel)->values;
  double sum = 0.0;
  for (std::size_t row = 0; row < measured.size(); ++row) sum += std::pow(measured[row] - simulated[row], 2);
  return std::sqrt(sum / static_cast<double>(measured.size()));
}

/// What the naive model lacks: the pump's dead voltage, and what runs over the upper tank's rim into the lower one.
struct Lacking {
  double dead_V = 0.0, overflow_1_s = 0.0, rim_V = 10.0;
};

// The tanks integrated by small steps of Euler's method, with noise: other code than the plant's.
TimeSeries noisy_tanks(double k4, double k1, double k3, double noise_std, const Lacking& lacking = {}) {
  std::mt19937 random(5);
  std::normal_distribution noise(0.0, noise_std);
  TimeSeries samples;
  samples.channels = {{"pump_voltage", "V", 0.0, {}}, {"level_voltage", "V", noise_std, {}}};
  double upper = 3.0, lower = 8.0;
  for (int row = 0; row < 500; ++row) {
    const double u = 3.0 + 1.2 * std::sin(0.05 * row) + 0.8 * std::sin(0.17 * row);
    samples.time_s.push_back(4.0 * row);
    samples.channels[0].values.push_back(u);
    samples.channels[1].values.push_back(lower + noise(random));
    constexpr double kStep_s = 1e-3;
    for (int k = 0; k < 4000; ++k) {
      const double over = lacking.overflow_1_s * std::max(upper - lacking.rim_V, 0.0);
      const double upper_outflow = k1 * std::sqrt(upper) + over;
      lower += kStep_s * (upper_outflow - k3 * std::sqrt(lower));
      upper += kStep_s * (k4 * (u - lacking.dead_V) - upper_outflow);
    }
  }
  return samples;
}

// The lower tank is the slower one by far: of two equally slow tanks a fit cannot say which is which.
TEST(CascadedTanksFit, FindsTheOutletsWithinTheirStandardErrors) {
  const TimeSeries samples = noisy_tanks(0.05, 0.08, 0.05, 0.02);
  const JointFit fit = fit_actuator(test::nominal_asset("cascaded_tanks"), {&samples, 1});
  EXPECT_TRUE(fit.report.admissible) << testing::PrintToString(fit.report.reasons);
  constexpr double kSigmas = 4.0;
  const std::vector<std::pair<const char*, double>> truth = {
      {"k4", 0.05}, {"k1", 0.08}, {"k3", 0.05}, {"initial:level_upper", 3.0}, {"initial:level_lower", 8.0}};
  for (const auto& [name, value] : truth) {
    const EstimatedParameter& found = parameter(fit.report, name);
    EXPECT_NEAR(found.value, value, kSigmas * found.std_error) << name;
    EXPECT_LT(found.std_error, 0.1 * value) << name;
  }
  EXPECT_EQ(parameter(fit.report, "initial:level_upper").unit, "V");
  ASSERT_EQ(fit.recordings.size(), 1u);
  EXPECT_TRUE(fit.recordings[0].load.name.empty()) << "tanks have no load";
  EXPECT_EQ(fit.recordings[0].initial_state.size(), 2u);
  EXPECT_NEAR(fit.report.channels.at(0).noise_normalised_rms, 1.0, 0.15);
}

// A sharp rim is not seen at all before the level reaches it, and its strength then wants to go anywhere: damping alone
// left steps so long that all were taken back, and a search was called converged where it had begun.
TEST(CascadedTanksFit, FindsTheRimFromAnyStart) {
  const TimeSeries samples = noisy_tanks(0.05, 0.04, 0.045, 0.02, {.dead_V = 0.6, .overflow_1_s = 0.3, .rim_V = 9.0});
  const auto setting = [](double value, double max) { return ParameterSetting{value, 0.0, max, true}; };
  for (const double rim_V : {7.0, 9.99, 12.0})
    for (const double dead_V : {0.3, 0.71}) {
      AssetConfig asset = test::nominal_asset("cascaded_tanks");
      asset.physics = {
          {"tank_overflow", "upper_outlet", {{"k", setting(0.13, 100.0)}, {"level_max", setting(rim_V, 60.0)}}},
          {"pump_dead_voltage", "pump", {{"V_0", setting(dead_V, 10.0)}, {"u_0", setting(0.1, 5.0)}}}};
      ActuatorFitOptions patient;
      patient.hopeless_rms = 1e9;
      patient.maximum_iterations = 200;
      const JointFit fit = fit_actuator(asset, {&samples, 1}, patient);
      EXPECT_TRUE(fit.report.converged) << fit.report.termination;
      EXPECT_NEAR(fit.report.channels.at(0).noise_normalised_rms, 1.0, 0.15) << rim_V << " " << dead_V;
    }
}

TEST(CascadedTanksFit, SaysHowFarTheNaiveModelIsFromTheRealTanks) {
  const auto file = test::shared_data("cascaded_tanks/train.csv");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no recording at " << file;
  const TimeSeries samples = test::read_recording(file);
  ActuatorFitOptions patient;
  patient.hopeless_rms = 1e9;
  const JointFit fit = fit_actuator(test::nominal_asset("cascaded_tanks"), {&samples, 1}, patient);
  EXPECT_TRUE(fit.report.converged) << fit.report.termination;
  EXPECT_FALSE(fit.report.admissible) << "tanks that overflow are not told by two outlets";
  EXPECT_THAT(fit.report.reasons, testing::Contains(testing::HasSubstr("level_voltage")));
  // An independent fit (Runge-Kutta, differences, many starts) ends at 0.603 V and 72.1 %.
  EXPECT_NEAR(rms_error(samples, fit.recordings.at(0), "level_voltage"), 0.603, 0.005);
  EXPECT_NEAR(fit.report.channels.at(0).nrmse_percent, 72.1, 0.3);
}

TEST(ActuatorFit, NeedsAThread) {
  ActuatorFitOptions options;
  EXPECT_TRUE(options.validate());
  options.threads = 0;
  EXPECT_FALSE(options.validate());
}

TEST(EmpsFit, SaysHowFarTheNaiveModelIsFromTheRealDrive) {
  const auto file = test::shared_data("emps/train.csv");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no recording at " << file;
  const TimeSeries samples = test::read_recording(file);
  ActuatorFitOptions patient;
  patient.hopeless_rms = 1e9;
  const JointFit fit = fit_actuator(test::nominal_asset("emps"), {&samples, 1}, patient);
  EXPECT_TRUE(fit.report.converged) << fit.report.termination;
  EXPECT_FALSE(fit.report.admissible) << "a drive with Coulomb friction and an offset is not told by mass and damping";
  // An independent fit (Runge-Kutta, held voltage) ends at 0.0432 m and 47.7 %.
  EXPECT_NEAR(rms_error(samples, fit.recordings.at(0), "position"), 0.0432, 5e-4);
  EXPECT_NEAR(fit.report.channels.at(0).nrmse_percent, 47.7, 0.5);
}

// Four seconds with closed valves; the chambers exchange oil through a leak of 1 / R_CL.
TimeSeries closed_valves(const AssetConfig& asset, double conductance, double noise_std) {
  using Plant = EhaSwitched;
  EhaSwitchedParameters<double> p{};
  EhaSwitchedParameters<double>::visit(
      [&](std::string_view name, double& value) {
        if (name != "load_factor") value = asset.parameters.at(std::string(name)).value;
      },
      p);
  std::mt19937 random(7);
  std::normal_distribution noise(0.0, noise_std);
  TimeSeries samples;
  samples.channels = {{"valve_state", "1", 0.0, {}},
                      {"pressure_a", "Pa", 0.0, {}},
                      {"pressure_b", "Pa", 0.0, {}},
                      {"position", "m", 0.0, {}}};
  const double x = 0.03, pipe = p.V_0 + Plant::pipe_volume(p.l_chamber, p);
  double p_A = 3e6, p_B = 5e5;
  for (int row = 0; row < 400; ++row) {
    samples.time_s.push_back(0.01 * row);
    const std::array<double, 4> values = {0.0, p_A + noise(random), p_B + noise(random), x};
    for (std::size_t c = 0; c < values.size(); ++c) samples.channels[c].values.push_back(values[c]);
    const double leak = conductance * (p_A - p_B) * 0.01;
    p_A -= leak * Plant::bulk_modulus(p_A, p) / (pipe + p.A_A * x);
    p_B += leak * Plant::bulk_modulus(p_B, p) / (pipe + p.A_B * (p.x_C - x));
  }
  return samples;
}

TEST(ClosedValves, TellTheLeakOrFromWhereOnItWouldNotShow) {
  const AssetConfig asset = test::nominal_asset("eha_switched");
  constexpr double kLeak = 1.0 / 1e14;
  const auto leaking = closed_valve_leakage(asset, closed_valves(asset, kLeak, 1e4));
  ASSERT_TRUE(leaking);
  EXPECT_NEAR(leaking->conductance, kLeak, 0.05 * kLeak + 3.0 * leaking->conductance_std);
  EXPECT_GT(leaking->conductance, 10.0 * leaking->conductance_std);
  const auto tight = closed_valve_leakage(asset, closed_valves(asset, 0.0, 1e4));
  ASSERT_TRUE(tight);
  EXPECT_LT(std::abs(tight->conductance), 3.0 * tight->conductance_std);
  EXPECT_THAT(in_words(*tight), testing::HasSubstr("R_CL is above"));
  EXPECT_FALSE(closed_valve_leakage(test::nominal_asset("eha"), closed_valves(asset, kLeak, 1e4)));
}

}  // namespace
}  // namespace sealwatch

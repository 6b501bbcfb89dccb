// Laws of the recording (input:<channel>, clock): a simulation with one in force equals a simulation, without it, of the
// recording as it should have been.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sealwatch/model/simulation.hpp"
#include "tests/unit/model/recording_for_tests.hpp"
#include "tests/unit/model/standard_pst.hpp"

namespace sealwatch {
namespace {

constexpr SimulationOptions kTight = {.relative_tolerance = 1e-8}, kVeryTight = {.relative_tolerance = 1e-10};

/// Of a channel's range: what the integrator's steps leave, which differ with the last digit of the input.
constexpr double kSame = 1e-4;

AssetConfig with_error(AssetConfig asset, const std::string& id, const std::string& element,
                       const std::string& parameter, double value) {
  asset.physics.push_back({.id = id, .element = element, .parameters = {{parameter, {value, -1e9, 1e9, true}}}});
  return asset;
}

RowMatrix outputs_of(const AssetConfig& asset, const TimeSeries& recorded) {
  const auto simulation = PlantSimulation::create(asset, recorded);
  EXPECT_TRUE(simulation) << simulation.error().describe();
  const auto outputs = (*simulation)->run((*simulation)->start(), {}, kTight);
  EXPECT_TRUE(outputs) << outputs.error().describe();
  return outputs->values;
}

/// Largest difference of a channel, of its range.
double worst_difference(const RowMatrix& a, const RowMatrix& b) {
  double worst = 0.0;
  for (Eigen::Index c = 0; c < a.cols(); ++c) {
    const double range = std::max(b.col(c).maxCoeff() - b.col(c).minCoeff(), 1e-12);
    worst = std::max(worst, (a.col(c) - b.col(c)).cwiseAbs().maxCoeff() / range);
  }
  return worst;
}

std::vector<double>& values_of(TimeSeries& samples, const std::string& name) {
  return std::ranges::find(samples.channels, name, &Series::name)->values;
}

TEST(RecordingLaws, GainAndBiasAreTheRecordsOwn) {
  const AssetConfig asset = with_error(nominal_asset("eha"), "clock_rate", "clock", "c", 0.0);
  const TimeSeries recorded = standard_pst(asset, 100.0);
  TimeSeries acted = recorded;
  for (double& volts : values_of(acted, "motor_voltage")) volts = 1.02 * volts + 0.3;
  const AssetConfig both = with_error(with_error(asset, "input_gain", "input:motor_voltage", "g", 0.02), "input_bias",
                                      "input:motor_voltage", "b", 0.3);
  EXPECT_LT(worst_difference(outputs_of(both, recorded), outputs_of(asset, acted)), kSame);
  EXPECT_GT(worst_difference(outputs_of(asset, recorded), outputs_of(asset, acted)), 100.0 * kSame) << "they matter";
}

TEST(RecordingLaws, AFastClockShowsMoreTimeThanThereWas) {
  const AssetConfig asset = with_error(nominal_asset("eha"), "input_gain", "input:motor_voltage", "g", 0.0);
  const TimeSeries acted = standard_pst(asset, 100.0);
  TimeSeries recorded = acted;
  for (double& time : recorded.time_s) time = acted.time_s.front() + 1.02 * (time - acted.time_s.front());
  const AssetConfig fast = with_error(asset, "clock_rate", "clock", "c", 0.02);
  EXPECT_LT(worst_difference(outputs_of(fast, recorded), outputs_of(asset, acted)), kSame);
  EXPECT_GT(worst_difference(outputs_of(asset, recorded), outputs_of(asset, acted)), 100.0 * kSame) << "it matters";
}

/// The voltage was stamped by a logger of its own, whose clock is fast: its record shows every ramp late and slow.
TEST(RecordingLaws, AnInputsOwnClockStretchesItsRecordAlone) {
  const AssetConfig asset = with_error(nominal_asset("eha"), "input_gain", "input:motor_voltage", "g", 0.0);
  const TimeSeries acted = standard_pst(asset, 100.0);
  TimeSeries recorded = acted;
  const std::vector<double>& volts = acted.channels.front().values;
  for (std::size_t row = 0; row < acted.time_s.size(); ++row) {
    const double at = (acted.time_s[row] - acted.time_s.front()) / 1.02 * 100.0;
    const auto before = static_cast<std::size_t>(at);
    const double next = volts[std::min(before + 1, volts.size() - 1)];
    recorded.channels.front().values[row] = std::lerp(volts[before], next, at - static_cast<double>(before));
  }
  ASSERT_EQ(acted.channels.front().name, "motor_voltage");
  const AssetConfig fast = with_error(asset, "input_clock_rate", "input:motor_voltage", "r", 0.02);
  constexpr double kCorners = 0.01;  // those between the record's samples are lost
  EXPECT_LT(worst_difference(outputs_of(fast, recorded), outputs_of(asset, acted)), kCorners);
  EXPECT_GT(worst_difference(outputs_of(asset, recorded), outputs_of(asset, acted)), 10.0 * kCorners) << "it matters";
}

/// Held inputs jump: a delay of whole samples moves the record's rows, one of half a sample cuts the step in two.
TEST(RecordingLaws, AHeldInputActsLate) {
  const AssetConfig asset = nominal_asset("cascaded_tanks");
  TimeSeries recorded{.time_s = {}, .channels = {{"pump_voltage", "V", 0.0, {}}, {"level_voltage", "V", 0.0, {}}}};
  for (int row = 0; row < 200; ++row) {
    recorded.time_s.push_back(4.0 * row);
    recorded.channels[0].values.push_back(3.0 + std::sin(0.05 * row) + (row / 20 % 2));
    recorded.channels[1].values.push_back(5.0);
  }
  TimeSeries late = recorded;
  std::vector<double>& volts = values_of(late, "pump_voltage");
  std::rotate(volts.rbegin(), volts.rbegin() + 1, volts.rend());
  volts.front() = values_of(recorded, "pump_voltage").front();
  const AssetConfig whole = with_error(asset, "input_delay", "input:pump_voltage", "tau", 4.0),
                    half = with_error(asset, "input_delay", "input:pump_voltage", "tau", 2.0);
  const RowMatrix now = outputs_of(asset, recorded), one_late = outputs_of(asset, late);
  EXPECT_LT(worst_difference(outputs_of(whole, recorded), one_late), 1e-6);
  EXPECT_GT(worst_difference(now, one_late), 1e-3) << "it matters";
  EXPECT_LT(worst_difference(2.0 * outputs_of(half, recorded) - now, one_late), 0.05) << "half of it in between";
}

/// An input that is linear between samples acts late by any time: a delay forth and a recording that was moved back.
TEST(RecordingLaws, ALinearInputActsLate) {
  const AssetConfig asset = nominal_asset("eha");
  const TimeSeries acted = standard_pst(asset, 100.0);
  TimeSeries early = acted;
  std::vector<double>& volts = values_of(early, "motor_voltage");
  std::rotate(volts.begin(), volts.begin() + 3, volts.end());
  std::fill(volts.end() - 3, volts.end(), values_of(const_cast<TimeSeries&>(acted), "motor_voltage").back());
  const AssetConfig late = with_error(asset, "input_delay", "input:motor_voltage", "tau", 0.03);
  EXPECT_LT(worst_difference(outputs_of(late, early), outputs_of(asset, acted)), 1e-3);
  EXPECT_GT(worst_difference(outputs_of(asset, early), outputs_of(asset, acted)), 1e-2) << "it matters";
}

/// The sensitivities of what is free against central differences of whole simulations over `steps`, all channels in their
/// sensors' noise, as every fit sums them.
void expect_slopes(const PlantSimulation& simulation, const std::vector<std::string>& names,
                   const std::vector<double>& steps, double tolerance) {
  std::vector<FreeQuantity> free;
  for (const std::string& name : names) free.push_back(*simulation.find(name));
  Eigen::RowVectorXd noise(std::ssize(simulation.channels()));
  for (Eigen::Index c = 0; c < noise.size(); ++c)
    noise(c) = simulation.plant().find_channel(simulation.channels()[static_cast<std::size_t>(c)])->noise_std;
  const auto outputs = simulation.run(simulation.start(), free);
  ASSERT_TRUE(outputs) << outputs.error().describe();
  for (std::size_t k = 0; k < free.size(); ++k) {
    ModelValues up = simulation.start(), down = simulation.start();
    free[k].in(up) += steps[k];
    free[k].in(down) -= steps[k];
    const RowMatrix after = simulation.run(up, {}, kVeryTight)->values,
                    before = simulation.run(down, {}, kVeryTight)->values;
    const RowMatrix difference = (after - before) / (2.0 * steps[k]) * noise.cwiseInverse().asDiagonal();
    const RowMatrix slope =
        outputs->sensitivities.col(static_cast<Eigen::Index>(k)).reshaped<Eigen::RowMajor>(after.rows(), after.cols()) *
        noise.cwiseInverse().asDiagonal();
    EXPECT_GT(difference.norm(), 0.0) << names[k];
    EXPECT_LT((slope - difference).norm() / difference.norm(), tolerance) << names[k];
  }
}

TEST(RecordingLaws, SensitivitiesAreThoseOfWholeSimulations) {
  AssetConfig asset = nominal_asset("eha");
  asset = with_error(asset, "input_gain", "input:motor_voltage", "g", 0.01);
  asset = with_error(asset, "input_bias", "input:motor_voltage", "b", 0.1);
  asset = with_error(asset, "input_delay", "input:motor_voltage", "tau", 0.004);
  asset = with_error(asset, "clock_rate", "clock", "c", 0.01);
  expect_slopes(**PlantSimulation::create(asset, standard_pst(asset, 100.0)),
                {"input:motor_voltage.input_gain.g", "input:motor_voltage.input_bias.b",
                 "input:motor_voltage.input_delay.tau", "clock.clock_rate.c"},
                {1e-3, 1e-2, 1e-4, 1e-4}, 0.02);
}

/// The input's corners move through the integrator's steps: what follows of it at once is known to some percent.
TEST(RecordingLaws, SensitivitiesBesideAnInputsOwnClock) {
  AssetConfig asset = with_error(nominal_asset("eha"), "input_delay", "input:motor_voltage", "tau", 0.004);
  asset = with_error(asset, "input_clock_rate", "input:motor_voltage", "r", 0.005);
  expect_slopes(**PlantSimulation::create(asset, standard_pst(asset, 100.0)),
                {"input:motor_voltage.input_delay.tau", "input:motor_voltage.input_clock_rate.r"}, {1e-4, 1e-5}, 0.1);
}

/// Beside a law that sees the input's slope, whose jumps at the samples a delay moves too: those are left out.
TEST(RecordingLaws, SensitivitiesBesideALawThatSeesTheInput) {
  AssetConfig asset = nominal_asset("eha");
  asset.physics.push_back(
      {.id = "driver_dead_time", .element = "driver", .parameters = {{"tau_d", {2e-3, 0, 0.1, true}}}});
  asset = with_error(asset, "input_gain", "input:motor_voltage", "g", 0.01);
  asset = with_error(asset, "input_delay", "input:motor_voltage", "tau", 0.004);
  asset = with_error(asset, "clock_rate", "clock", "c", 0.01);
  const auto simulation = PlantSimulation::create(asset, standard_pst(asset, 100.0));
  ASSERT_TRUE(simulation) << simulation.error().describe();
  expect_slopes(**simulation, {"input:motor_voltage.input_gain.g", "clock.clock_rate.c"}, {1e-3, 1e-4}, 0.02);
  expect_slopes(**simulation, {"input:motor_voltage.input_delay.tau"}, {1e-4}, 0.1);
}

/// A held input: a delay moves its jumps.
TEST(RecordingLaws, SensitivitiesOfAHeldInput) {
  AssetConfig asset = nominal_asset("cascaded_tanks");
  TimeSeries recorded{.time_s = {}, .channels = {{"pump_voltage", "V", 0.0, {}}, {"level_voltage", "V", 0.0, {}}}};
  for (int row = 0; row < 100; ++row) {
    recorded.time_s.push_back(4.0 * row);
    recorded.channels[0].values.push_back(3.0 + std::sin(0.05 * row) + (row / 20 % 2));
    recorded.channels[1].values.push_back(5.0);
  }
  asset = with_error(asset, "input_gain", "input:pump_voltage", "g", 0.01);
  asset = with_error(asset, "input_bias", "input:pump_voltage", "b", 0.1);
  asset = with_error(asset, "input_delay", "input:pump_voltage", "tau", 1.0);
  asset = with_error(asset, "input_clock_rate", "input:pump_voltage", "r", 0.02);
  asset = with_error(asset, "clock_rate", "clock", "c", 0.01);
  expect_slopes(**PlantSimulation::create(asset, recorded),
                {"input:pump_voltage.input_gain.g", "input:pump_voltage.input_bias.b",
                 "input:pump_voltage.input_delay.tau", "input:pump_voltage.input_clock_rate.r", "clock.clock_rate.c"},
                {1e-3, 1e-2, 0.1, 1e-4, 1e-4}, 0.01);
}

TimeSeries driven_by_flow() {
  TimeSeries acted;
  for (int row = 0; row < 800; ++row) acted.time_s.push_back(0.01 * row);
  for (const char* name : {"flow", "pressure_a", "velocity", "position"}) {
    Series series{name, (*find_plant("eha"))->find_channel(name)->unit, 0.0, {}};
    for (const double t : acted.time_s)
      series.values.push_back(series.name == "flow"
                                  ? 8e-6 * std::tanh(4.0 * (t - 1.0)) - 8e-6 * std::tanh(4.0 * (t - 5.0))
                              : series.name == "pressure_a" ? 1e7
                              : series.name == "position"   ? 0.03
                                                            : 0.0);
    acted.channels.push_back(std::move(series));
  }
  return acted;
}

/// The cylinder's circuit is driven by the measured flow: its sensor's errors are taken off it.
TEST(RecordingLaws, ASensorThatDrivesIsPutRight) {
  const AssetConfig asset = with_error(nominal_asset("eha"), "clock_rate", "clock", "c", 0.0);
  const TimeSeries acted = driven_by_flow();
  TimeSeries recorded = acted;
  for (double& flow : values_of(recorded, "flow")) flow = 1.03 * flow + 1e-7;
  const AssetConfig known =
      with_error(with_error(asset, "sensor_gain", "sensor:flow", "g", 0.03), "sensor_bias", "sensor:flow", "b", 1e-7);
  const auto simulation = *PlantSimulation::create(known, recorded);
  ASSERT_NE(std::ranges::find(simulation->inputs(), "flow"), simulation->inputs().end());
  EXPECT_LT(worst_difference(outputs_of(known, recorded), outputs_of(asset, acted)), kSame);
  EXPECT_GT(worst_difference(outputs_of(asset, recorded), outputs_of(asset, acted)), 100.0 * kSame) << "it matters";
  const AssetConfig late = with_error(known, "sensor_lag", "sensor:flow", "tau", 0.02);
  expect_slopes(
      **PlantSimulation::create(late, recorded),
      {"sensor:flow.sensor_gain.g", "sensor:flow.sensor_bias.b", "sensor:flow.sensor_lag.tau", "clock.clock_rate.c"},
      {1e-3, 1e-8, 1e-3, 1e-4}, 0.02);
}

/// The same errors, known within the sensor's tolerance rather than as laws.
TEST(RecordingLaws, ASensorThatDrivesIsOffByWhatTheAssetSays) {
  const AssetConfig asset = with_error(nominal_asset("eha"), "clock_rate", "clock", "c", 0.0);
  const TimeSeries acted = driven_by_flow();
  TimeSeries recorded = acted;
  for (double& flow : values_of(recorded, "flow")) flow = 1.03 * flow + 1e-7;
  AssetConfig known = asset;
  known.sensors["flow"].gain_error = 0.03;
  known.sensors["flow"].offset_error = 1e-7;
  EXPECT_LT(worst_difference(outputs_of(known, recorded), outputs_of(asset, acted)), kSame);
  expect_slopes(**PlantSimulation::create(known, recorded), {"sensor:flow.gain_error", "sensor:flow.offset_error"},
                {1e-3, 1e-8}, 0.02);
}

/// A zero that moves, with all else that a sensor may do: time counts from the first sample, wherever that is.
TEST(RecordingLaws, SensitivitiesOfADriftingSensor) {
  AssetConfig asset = with_error(nominal_asset("eha"), "sensor_gain", "sensor:shaft_speed", "g", 0.02);
  asset = with_error(asset, "sensor_lag", "sensor:shaft_speed", "tau", 0.01);
  asset.physics.push_back({.id = "sensor_drift",
                           .element = "sensor:shaft_speed",
                           .parameters = {{"D", {-3.0, -10.0, 10.0, true}}, {"T", {6.0, 0.5, 1e4, true}}}});
  TimeSeries recorded = standard_pst(asset, 100.0);
  for (double& time : recorded.time_s) time += 50.0;
  expect_slopes(
      **PlantSimulation::create(asset, recorded),
      {"sensor:shaft_speed.sensor_gain.g", "sensor:shaft_speed.sensor_drift.D", "sensor:shaft_speed.sensor_drift.T"},
      {1e-4, 1e-2, 1e-2}, 0.01);
}

TEST(RecordingLaws, AnElementThatIsNoneIsAnError) {
  const AssetConfig asset = nominal_asset("eha");
  const TimeSeries recorded = standard_pst(asset, 100.0);
  for (const auto& [id, element] : {std::pair{"input_gain", "input:nowhere"}, {"input_gain", "piston"}})
    EXPECT_NE(PlantSimulation::create(with_error(asset, id, element, "g", 0.1), recorded)
                  .error()
                  .describe()
                  .find("input:<channel>"),
              std::string::npos);
  const auto clock = PlantSimulation::create(with_error(asset, "clock_rate", "shaft", "c", 0.1), recorded);
  EXPECT_NE(clock.error().describe().find("as clock"), std::string::npos);
}

}  // namespace
}  // namespace sealwatch

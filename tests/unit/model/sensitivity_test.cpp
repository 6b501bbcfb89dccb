// Forward sensitivities of all channels against central differences of whole simulations, for every parameter, the load
// factor and every initial state.
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "sealwatch/model/simulation.hpp"
#include "tests/unit/model/standard_pst.hpp"

namespace sealwatch {
namespace {

constexpr SimulationOptions kTight = {.relative_tolerance = 1e-10};

/// Relative step of the differences, and the error that they have: integration errors divided by the step, and the
/// curvature.
struct Differences {
  double step = 1e-4;
  double error = 4e-3;        ///< relative, root mean square over the samples
  double integration = 1e-8;  ///< of the values, relative
};

std::vector<FreeQuantity> all_quantities(const PlantSimulation& simulation, bool initial_states) {
  std::vector<FreeQuantity> free = {simulation.find(sensor_gain_name(simulation.channels().front())).value()};
  for (const auto& parameter : simulation.plant().parameters) free.push_back(simulation.find(parameter.name).value());
  free.push_back(simulation.find("load_factor").value());
  if (initial_states)
    for (const auto& state : simulation.slow_state_names()) free.push_back(simulation.find("initial:" + state).value());
  free.push_back(simulation.find(sensor_offset_name(simulation.channels().back())).value());
  return free;
}

double step_of(const FreeQuantity& quantity, const ModelValues& values, double relative) {
  const double value = std::abs(quantity.in(values));
  const bool absolute = quantity.kind == FreeQuantity::Kind::load_factor || value == 0.0;
  return absolute ? relative : relative * value;
}

void check(const PlantSimulation& simulation, const ModelValues& values, const Differences& differences) {
  const auto free = all_quantities(simulation, true);
  const auto outputs = simulation.run(values, free, kTight);
  ASSERT_TRUE(outputs) << outputs.error().describe();
  const Eigen::Index channels = outputs->values.cols(), samples = outputs->values.rows();
  for (std::size_t k = 0; k < free.size(); ++k) {
    ModelValues up = values, down = values;
    const double step = step_of(free[k], values, differences.step);
    free[k].in(up) += step;
    free[k].in(down) -= step;
    // The same initial states must be held, or the differences would see another quasi-steady start.
    const auto after = simulation.run(up, {}, kTight), before = simulation.run(down, {}, kTight);
    ASSERT_TRUE(after && before);
    for (Eigen::Index c = 0; c < channels; ++c) {
      double size = 0.0, error = 0.0;
      for (Eigen::Index row = 0; row < samples; ++row) {
        const double difference = (after->values(row, c) - before->values(row, c)) / (2.0 * step);
        size += difference * difference;
        const double slope = outputs->sensitivities(row * channels + c, static_cast<Eigen::Index>(k));
        error += (difference - slope) * (difference - slope);
      }
      const double rounding = differences.integration * outputs->values.col(c).cwiseAbs().maxCoeff() / step;
      EXPECT_LE(std::sqrt(error),
                differences.error * std::sqrt(size) + rounding * std::sqrt(static_cast<double>(samples)))
          << simulation.channels()[static_cast<std::size_t>(c)] << " to quantity " << k << " of size "
          << std::sqrt(size);
    }
  }
}

/// Sensors without lag: their filters are linear and pass values and sensitivities alike, but which points in time they
/// see depends on the steps, which makes differences of whole simulations rough.
AssetConfig asset_without_lags(const std::string& model) {
  AssetConfig asset = nominal_asset(model);
  for (auto& [channel, sensor] : asset.sensors) sensor.time_constant_s = 0.0;
  return asset;
}

TEST(Sensitivities, OfEhaAgreeWithDifferencesForEveryQuantity) {
  const AssetConfig asset = asset_without_lags("eha");
  const auto simulation = PlantSimulation::create(asset, standard_pst(asset, 100.0, 4.0));
  ASSERT_TRUE(simulation);
  ModelValues values = (*simulation)->start();
  values.load_factor = 0.05;
  check(**simulation, values, {});
}

/// One second each of extension, rest and retraction under smooth voltage.
TimeSeries switched_cycle() {
  TimeSeries samples;
  samples.channels = {{"motor_duty", "1", 0.0, {}},  {"valve_state", "1", 0.0, {}}, {"position", "m", 0.0, {}},
                      {"pressure_a", "Pa", 0.0, {}}, {"pressure_b", "Pa", 0.0, {}}, {"shaft_speed", "rad/s", 0.0, {}},
                      {"pump_angle", "rad", 0.0, {}}};
  for (int row = 0; row < 300; ++row) {
    const double t = 0.01 * row, phase = std::sin(std::numbers::pi * t);
    const double valve = t < 1.0 ? 1.0 : (t < 2.0 ? 0.0 : -1.0);
    samples.time_s.push_back(t);
    const std::array<double, 7> values = {0.5 * valve * phase * phase, valve, 0.02, 1.0e6, 3.0e5, 0.0, 0.0};
    for (std::size_t c = 0; c < values.size(); ++c) samples.channels[c].values.push_back(values[c]);
  }
  return samples;
}

TEST(Sensitivities, OfEhaSwitchedAgreeWithDifferencesAcrossItsValveChanges) {
  AssetConfig asset = asset_without_lags("eha_switched");
  asset.parameters.at("f_C").value =
      2e4;  // damped, so that differences of trajectories are not those of a ringing phase
  const auto simulation = PlantSimulation::create(asset, switched_cycle());
  ASSERT_TRUE(simulation);
  // The bench's motor has hardly any inertia: its speed jumps with the pressures, and differences are rougher.
  check(**simulation, (*simulation)->start(), {.step = 1e-3, .error = 3e-2, .integration = 1e-7});
}

TEST(Sensitivities, DoNotChangeTheStatesAndDoNotDependOnTheirCompany) {
  const AssetConfig asset = nominal_asset("eha");
  const auto simulation = PlantSimulation::create(asset, standard_pst(asset, 100.0, 4.0));
  ASSERT_TRUE(simulation);
  const ModelValues& values = (*simulation)->start();
  const auto all = all_quantities(**simulation, true);
  const std::vector<FreeQuantity> one = {(*simulation)->find("R_CL").value()};
  const auto alone = (*simulation)->run(values, one), together = (*simulation)->run(values, all);
  ASSERT_TRUE(alone && together);
  const auto column = static_cast<Eigen::Index>(one.front().index) + 1;  // a sensor's comes first
  const double size = alone->sensitivities.col(0).cwiseAbs().maxCoeff();
  EXPECT_LT((alone->sensitivities.col(0) - together->sensitivities.col(column)).cwiseAbs().maxCoeff(), 1e-9 * size);
  const auto plain = (*simulation)->run(values, {});
  for (Eigen::Index c = 0; c < plain->values.cols(); ++c)
    EXPECT_LT((plain->values.col(c) - together->values.col(c)).cwiseAbs().maxCoeff(),
              1e-9 * plain->values.col(c).cwiseAbs().maxCoeff() + 1e-15);
}

}  // namespace
}  // namespace sealwatch

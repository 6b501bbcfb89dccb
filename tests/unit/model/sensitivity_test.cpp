// Forward sensitivities of all channels against central differences of whole simulations, for every parameter, the load
// factor and every initial state.
#include <gtest/gtest.h>

#include <algorithm>

#include "sealwatch/model/simulation.hpp"
#include "tests/unit/model/standard_pst.hpp"

namespace sealwatch {
namespace {

constexpr SimulationOptions kTight = {.relative_tolerance = 1e-10};

/// Differences of two simulations carry their integration errors, divided by the step: relative error of the largest
/// entry.
constexpr double kDifferenceError = 4e-3;

std::vector<FreeQuantity> all_quantities(const PlantSimulation& simulation, bool initial_states) {
  std::vector<FreeQuantity> free;
  for (const auto& parameter : simulation.plant().parameters) free.push_back(simulation.find(parameter.name).value());
  free.push_back(simulation.find("load_factor").value());
  if (initial_states)
    for (const auto& state : simulation.slow_state_names()) free.push_back(simulation.find("initial:" + state).value());
  return free;
}

double step_of(const FreeQuantity& quantity, const ModelValues& values) {
  const double value = std::abs(quantity.in(values));
  if (quantity.kind == FreeQuantity::Kind::load_factor) return 1e-4;
  return value > 0.0 ? 1e-4 * value : 1e-4;
}

void check(const PlantSimulation& simulation, const ModelValues& values) {
  const auto free = all_quantities(simulation, true);
  const auto outputs = simulation.run(values, free, kTight);
  ASSERT_TRUE(outputs) << outputs.error().describe();
  const Eigen::Index channels = outputs->values.cols(), samples = outputs->values.rows();
  for (std::size_t k = 0; k < free.size(); ++k) {
    ModelValues up = values, down = values;
    const double step = step_of(free[k], values);
    free[k].in(up) += step;
    free[k].in(down) -= step;
    // The same initial states must be held, or the differences would see another quasi-steady start.
    const auto after = simulation.run(up, {}, kTight), before = simulation.run(down, {}, kTight);
    ASSERT_TRUE(after && before);
    for (Eigen::Index c = 0; c < channels; ++c) {
      double largest = 0.0, error = 0.0;
      for (Eigen::Index row = 0; row < samples; ++row) {
        const double difference = (after->values(row, c) - before->values(row, c)) / (2.0 * step);
        largest = std::max(largest, std::abs(difference));
        error = std::max(
            error, std::abs(difference - outputs->sensitivities(row * channels + c, static_cast<Eigen::Index>(k))));
      }
      const double rounding = 1e-9 * outputs->values.col(c).cwiseAbs().maxCoeff() / step;
      EXPECT_LE(error, kDifferenceError * largest + 10.0 * rounding)
          << simulation.channels()[static_cast<std::size_t>(c)] << " to quantity " << k << " of size " << largest;
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
  check(**simulation, values);
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
  const auto column = static_cast<Eigen::Index>(one.front().index);
  const double size = alone->sensitivities.col(0).cwiseAbs().maxCoeff();
  EXPECT_LT((alone->sensitivities.col(0) - together->sensitivities.col(column)).cwiseAbs().maxCoeff(), 1e-9 * size);
  const auto plain = (*simulation)->run(values, {});
  for (Eigen::Index c = 0; c < plain->values.cols(); ++c)
    EXPECT_LT((plain->values.col(c) - together->values.col(c)).cwiseAbs().maxCoeff(),
              1e-9 * plain->values.col(c).cwiseAbs().maxCoeff() + 1e-15);
}

}  // namespace
}  // namespace sealwatch

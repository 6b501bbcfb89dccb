#include "services/common/model/emps_model.hpp"
#include "services/common/model/simulation_plants.hpp"

namespace sealwatch {
namespace {

/// The controller holds its voltage from one sample to the next. A course that is linear between the means of
/// neighbours has the same delay and the same area, and the integrator need not start anew at every sample.
std::vector<double> means_of_neighbours(const std::vector<double>& held) {
  std::vector<double> means = held;
  for (std::size_t row = 1; row < held.size(); ++row) means[row] = 0.5 * (held[row - 1] + held[row]);
  return means;
}

}  // namespace

std::unique_ptr<PlantSimulation> simulate_emps(const PlantDescription& plant, const AssetConfig& asset,
                                               const TimeSeries& recorded, PhysicsTerms terms) {
  if (recorded.input_hold)
    return std::make_unique<PlantSimulationOf<EmpsModel>>(plant, asset, recorded, std::move(terms));
  TimeSeries smoothed = recorded;
  for (Series& channel : smoothed.channels)
    if (channel.name == "motor_voltage") channel.values = means_of_neighbours(channel.values);
  return std::make_unique<PlantSimulationOf<EmpsModel>>(plant, asset, smoothed, std::move(terms));
}

}  // namespace sealwatch

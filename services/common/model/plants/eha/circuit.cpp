#include "services/common/model/measured_input.hpp"
#include "services/common/model/plants/eha/circuit_model.hpp"
#include "services/common/model/plants/eha/flow_driven_model.hpp"
#include "services/common/model/simulation_plants.hpp"

namespace sealwatch {
namespace {

double time_constant_of(const PlantDescription& plant, const AssetConfig& asset, const std::string& channel) {
  const auto sensor = asset.sensors.find(channel);
  return sensor != asset.sensors.end() ? sensor->second.time_constant_s : plant.find_channel(channel)->time_constant_s;
}

/// With the lags of the sensors that drive the simulation undone.
TimeSeries with_inputs_undone(const PlantDescription& plant, const AssetConfig& asset, const TimeSeries& recorded) {
  TimeSeries inputs = recorded;
  for (Series& channel : inputs.channels)
    if (channel.name == "flow" || channel.name == "pressure_b")
      channel.values = undo_sensor(recorded.time_s, channel.values, time_constant_of(plant, asset, channel.name));
  return inputs;
}

}  // namespace

std::unique_ptr<PlantSimulation> simulate_eha_circuit(const PlantDescription& plant, const AssetConfig& asset,
                                                      const TimeSeries& recorded, PhysicsTerms terms) {
  return std::make_unique<PlantSimulationOf<EhaCircuitModel>>(plant, asset, with_inputs_undone(plant, asset, recorded),
                                                              std::move(terms));
}

std::unique_ptr<PlantSimulation> simulate_eha_flow_driven(const PlantDescription& plant, const AssetConfig& asset,
                                                          const TimeSeries& recorded, PhysicsTerms terms) {
  return std::make_unique<PlantSimulationOf<EhaFlowDrivenModel>>(
      plant, asset, with_inputs_undone(plant, asset, recorded), std::move(terms));
}

}  // namespace sealwatch

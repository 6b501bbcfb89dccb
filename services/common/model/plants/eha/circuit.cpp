#include "services/common/model/measured_input.hpp"
#include "services/common/model/plants/eha/circuit_model.hpp"
#include "services/common/model/simulation_plants.hpp"

namespace sealwatch {
namespace {

double time_constant_of(const PlantDescription& plant, const AssetConfig& asset, const std::string& channel) {
  const auto sensor = asset.sensors.find(channel);
  return sensor != asset.sensors.end() ? sensor->second.time_constant_s : plant.find_channel(channel)->time_constant_s;
}

}  // namespace

// The recorded flow and pressure drive the circuit: their sensors' lags are undone, and where the other chamber's
// pressure is not recorded it is the reservoir's.
std::unique_ptr<PlantSimulation> simulate_eha_circuit(const PlantDescription& plant, const AssetConfig& asset,
                                                      const TimeSeries& recorded, PhysicsTerms terms) {
  TimeSeries inputs = recorded;
  for (Series& channel : inputs.channels)
    if (channel.name == "flow" || channel.name == "pressure_b")
      channel.values = undo_sensor(recorded.time_s, channel.values, time_constant_of(plant, asset, channel.name));
  if (!recorded.has("pressure_b")) {
    const ModelValues values{parameter_values(plant, asset), 0.0, {}};
    inputs.channels.push_back(
        {"pressure_b", "Pa", 0.0, std::vector<double>(recorded.time_s.size(), parameter_value(plant, values, "p_0"))});
  }
  return std::make_unique<PlantSimulationOf<EhaCircuitModel>>(plant, asset, inputs, std::move(terms));
}

}  // namespace sealwatch

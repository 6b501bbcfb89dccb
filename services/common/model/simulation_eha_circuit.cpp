#include "services/common/model/eha_circuit_model.hpp"
#include "services/common/model/simulation_plants.hpp"

namespace sealwatch {

std::unique_ptr<PlantSimulation> simulate_eha_circuit(const PlantDescription& plant, const AssetConfig& asset,
                                                      const TimeSeries& recorded, PhysicsTerms terms) {
  if (recorded.has("pressure_b"))
    return std::make_unique<PlantSimulationOf<EhaCircuitModel>>(plant, asset, recorded, std::move(terms));
  TimeSeries completed = recorded;
  const ModelValues values{parameter_values(plant, asset), 0.0, {}};
  completed.channels.push_back(
      {"pressure_b", "Pa", 0.0, std::vector<double>(recorded.time_s.size(), parameter_value(plant, values, "p_0"))});
  return std::make_unique<PlantSimulationOf<EhaCircuitModel>>(plant, asset, completed, std::move(terms));
}

}  // namespace sealwatch

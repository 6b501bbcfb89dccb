#include "services/common/model/eha_switched_model.hpp"
#include "services/common/model/simulation_plants.hpp"

namespace sealwatch {

std::unique_ptr<PlantSimulation> simulate_eha_switched(const PlantDescription& plant, const AssetConfig& asset,
                                                       const TimeSeries& recorded, PhysicsTerms terms) {
  return std::make_unique<PlantSimulationOf<EhaSwitchedModel>>(plant, asset, recorded, std::move(terms));
}

}  // namespace sealwatch

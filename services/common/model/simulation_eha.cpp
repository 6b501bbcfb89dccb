#include "services/common/model/eha_model.hpp"
#include "services/common/model/simulation_plants.hpp"

namespace sealwatch {

std::unique_ptr<PlantSimulation> simulate_eha(const PlantDescription& plant, const AssetConfig& asset,
                                              const TimeSeries& recorded, PhysicsTerms terms) {
  return std::make_unique<PlantSimulationOf<EhaModel>>(plant, asset, recorded, std::move(terms));
}

}  // namespace sealwatch

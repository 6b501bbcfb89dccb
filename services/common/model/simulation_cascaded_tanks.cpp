#include "services/common/model/cascaded_tanks_model.hpp"
#include "services/common/model/simulation_plants.hpp"

namespace sealwatch {

std::unique_ptr<PlantSimulation> simulate_cascaded_tanks(const PlantDescription& plant, const AssetConfig& asset,
                                                         const TimeSeries& recorded, PhysicsTerms terms) {
  return std::make_unique<PlantSimulationOf<CascadedTanksModel>>(plant, asset, recorded, std::move(terms));
}

}  // namespace sealwatch

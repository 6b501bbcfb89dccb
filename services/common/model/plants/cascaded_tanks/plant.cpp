#include "services/common/model/plants/cascaded_tanks/model.hpp"
#include "services/common/model/simulation_plants.hpp"

namespace sealwatch {
namespace plants {
NativePlant cascaded_tanks();
}

namespace {

std::unique_ptr<PlantSimulation> simulate_cascaded_tanks(const PlantDescription& plant, const AssetConfig& asset,
                                                         const TimeSeries& recorded, PhysicsTerms terms) {
  return std::make_unique<PlantSimulationOf<CascadedTanksModel>>(plant, asset, recorded, std::move(terms));
}

}  // namespace

PlantDescription describe_cascaded_tanks();

NativePlant plants::cascaded_tanks() {
  return {.description = describe_cascaded_tanks(),
          .simulator = {.model = "cascaded_tanks", .inputs = {"pump_voltage"}, .simulate = &simulate_cascaded_tanks}};
}

}  // namespace sealwatch

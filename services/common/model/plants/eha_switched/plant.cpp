#include "services/common/model/plants/eha_switched/model.hpp"
#include "services/common/model/simulation_plants.hpp"

namespace sealwatch {
namespace plants {
NativePlant eha_switched();
}

namespace {

std::unique_ptr<PlantSimulation> simulate_eha_switched(const PlantDescription& plant, const AssetConfig& asset,
                                                       const TimeSeries& recorded, PhysicsTerms terms) {
  return std::make_unique<PlantSimulationOf<EhaSwitchedModel>>(plant, asset, recorded, std::move(terms));
}

}  // namespace

PlantDescription describe_eha_switched();

NativePlant plants::eha_switched() {
  return {.description = describe_eha_switched(),
          .simulator = {
              .model = "eha_switched", .inputs = {"motor_duty", "valve_state"}, .simulate = &simulate_eha_switched}};
}

}  // namespace sealwatch

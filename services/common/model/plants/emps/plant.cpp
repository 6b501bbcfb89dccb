#include "services/common/model/measured_input.hpp"
#include "services/common/model/plants/emps/model.hpp"
#include "services/common/model/simulation_plants.hpp"

namespace sealwatch {
namespace plants {
NativePlant emps();
}

namespace {

std::unique_ptr<PlantSimulation> simulate_emps(const PlantDescription& plant, const AssetConfig& asset,
                                               const TimeSeries& recorded, PhysicsTerms terms) {
  if (recorded.input_hold)
    return std::make_unique<PlantSimulationOf<EmpsModel>>(plant, asset, recorded, std::move(terms));
  TimeSeries smoothed = recorded;
  for (Series& channel : smoothed.channels)
    if (channel.name == "motor_voltage") channel.values = means_of_neighbours(channel.values);
  return std::make_unique<PlantSimulationOf<EmpsModel>>(plant, asset, smoothed, std::move(terms));
}

}  // namespace

PlantDescription describe_emps();

NativePlant plants::emps() {
  return {.description = describe_emps(),
          .simulator = {.model = "emps", .inputs = {"motor_voltage"}, .simulate = &simulate_emps}};
}

}  // namespace sealwatch

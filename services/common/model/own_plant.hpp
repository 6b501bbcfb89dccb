// A plant of one's own beside those that come with sealwatch (docs/reference/plant-in-cpp.md): its table and its equations are
// made known once, at the start of the program, before other threads run. From then on every module takes it by name.
#pragma once

#include <utility>

#include "services/common/model/plant_physics.hpp"
#include "services/common/model/simulation_plants.hpp"
#include "services/common/model/start_values.hpp"

namespace sealwatch {

/// Model: plant_simulation.hpp.
template <class Model>
Status add_plant(PlantDescription description) {
  PlantSimulator simulator{.model = description.name, .inputs = {}, .simulate = nullptr};
  for (const ModelInput& input : Model::kInputs) simulator.inputs.emplace_back(input.name);
  simulator.simulate = [](const PlantDescription& plant, const AssetConfig& asset, const TimeSeries& recorded,
                          PhysicsTerms terms) -> std::unique_ptr<PlantSimulation> {
    return std::make_unique<PlantSimulationOf<Model>>(plant, asset, recorded, std::move(terms));
  };
  return add_plant(std::move(description), std::move(simulator));
}

}  // namespace sealwatch

// A plant from its model (plant_simulation.hpp): what plants/X/plant.cpp and own_plant.hpp register.
#pragma once

#include <memory>
#include <utility>

#include "services/common/model/plant_simulation.hpp"
#include "services/common/model/simulation_plants.hpp"
#include "services/common/model/start_values.hpp"

namespace sealwatch {

template <class Model>
std::unique_ptr<PlantSimulation> simulate_as(const PlantDescription& plant, const AssetConfig& asset,
                                             const TimeSeries& recorded, PhysicsTerms terms) {
  return std::make_unique<PlantSimulationOf<Model>>(plant, asset, recorded, std::move(terms));
}

/// `simulate`: where the recording is prepared first.
template <class Model>
NativePlant native_plant(PlantDescription description, SimulatePlant simulate = &simulate_as<Model>) {
  PlantSimulator simulator{.model = description.name, .inputs = {}, .simulate = std::move(simulate)};
  for (const ModelInput& input : Model::kInputs) simulator.inputs.emplace_back(input.name);
  return {.description = std::move(description), .simulator = std::move(simulator)};
}

}  // namespace sealwatch

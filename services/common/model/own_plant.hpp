// A plant of one's own beside those that come with sealwatch (docs/reference/plant-in-cpp.md): its table and its equations are
// made known once, at the start of the program, before other threads run. From then on every module takes it by name.
#pragma once

#include <utility>

#include "services/common/model/native_plant.hpp"
#include "services/common/model/plant_physics.hpp"

namespace sealwatch {

/// Model: plant_simulation.hpp.
template <class Model>
Status add_plant(PlantDescription description) {
  NativePlant plant = native_plant<Model>(std::move(description));
  return add_plant(std::move(plant.description), std::move(plant.simulator));
}

}  // namespace sealwatch

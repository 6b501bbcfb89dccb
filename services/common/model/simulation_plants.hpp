// What makes the simulation of a recording, by plant. Each has its heavy templates in a file of its own.
#pragma once

#include <functional>
#include <memory>

#include "sealwatch/model/driving_channels.hpp"
#include "sealwatch/model/simulation.hpp"
#include "services/common/model/physics_terms.hpp"

namespace sealwatch {

using SimulatePlant = std::function<Result<std::unique_ptr<PlantSimulation>>(
    const PlantDescription&, const AssetConfig&, const TimeSeries&, PhysicsTerms)>;

/// A part of the plant that other recorded channels can drive; it has no sites but these.
struct AlternativeSimulator {
  PlantPart part;
  std::vector<Site> sites;
  SimulatePlant simulate = nullptr;
};

struct PlantSimulator {
  std::string model;                ///< name of the plant
  std::vector<std::string> inputs;  ///< that must be recorded
  SimulatePlant simulate = nullptr;
  std::vector<AlternativeSimulator> alternatives = {};  ///< where `inputs` are not recorded: the first
  PlantPart whole = {};                                 ///< no inputs of its own: the plant's
};

/// A plant that comes with sealwatch: a folder of services/common/model/plants.
struct NativePlant {
  PlantDescription description;
  PlantSimulator simulator;
};
[[nodiscard]] const std::vector<NativePlant>& native_plants();  // made by the build

/// An Error when a plant of that name is known already.
Status add_plant(PlantDescription description, PlantSimulator simulator);

}  // namespace sealwatch

// Makes the simulation of a recording, one function per plant, each with its heavy templates in a file of its own.
#pragma once

#include <functional>
#include <memory>

#include "sealwatch/model/simulation.hpp"
#include "services/common/model/physics_terms.hpp"

namespace sealwatch {

[[nodiscard]] std::unique_ptr<PlantSimulation> simulate_eha(const PlantDescription& plant, const AssetConfig& asset,
                                                            const TimeSeries& recorded, PhysicsTerms terms);
/// The cylinder circuit of `eha`, driven by the recorded flow.
[[nodiscard]] std::unique_ptr<PlantSimulation> simulate_eha_circuit(const PlantDescription& plant,
                                                                    const AssetConfig& asset,
                                                                    const TimeSeries& recorded, PhysicsTerms terms);
[[nodiscard]] std::unique_ptr<PlantSimulation> simulate_eha_switched(const PlantDescription& plant,
                                                                     const AssetConfig& asset,
                                                                     const TimeSeries& recorded, PhysicsTerms terms);
[[nodiscard]] std::unique_ptr<PlantSimulation> simulate_emps(const PlantDescription& plant, const AssetConfig& asset,
                                                             const TimeSeries& recorded, PhysicsTerms terms);
[[nodiscard]] std::unique_ptr<PlantSimulation> simulate_cascaded_tanks(const PlantDescription& plant,
                                                                       const AssetConfig& asset,
                                                                       const TimeSeries& recorded, PhysicsTerms terms);

using SimulatePlant = std::function<Result<std::unique_ptr<PlantSimulation>>(
    const PlantDescription&, const AssetConfig&, const TimeSeries&, PhysicsTerms)>;

struct PlantSimulator {
  std::string model;                ///< name of the plant
  std::vector<std::string> inputs;  ///< that must be recorded
  SimulatePlant simulate = nullptr;
};

/// An Error when a plant of that name is known already.
Status add_plant(PlantDescription description, PlantSimulator simulator);

}  // namespace sealwatch

// Simulation with laws in force and with injected columns: heavy to compile, so each plant does it in a file of its
// own (plants/eha/with_physics.cpp).
#pragma once

#include "services/common/model/plant_simulation.hpp"

namespace sealwatch {

inline constexpr int kPhysicsWidth = 8;

template <class Model>
Result<SimulatedOutputs> PlantSimulationOf<Model>::run_with_physics(const RecordedInput& input,
                                                                    const ModelValues& values,
                                                                    std::span<const FreeQuantity> free,
                                                                    const SimulationOptions& options,
                                                                    InjectedColumns* injected) const {
  if constexpr (requires { Model::Equations::kSites; })
    return run_with<kPhysicsWidth, true>(input, values, free, options, injected);
  return fail("plant " + plant().name + " has no sites for laws");
}

}  // namespace sealwatch

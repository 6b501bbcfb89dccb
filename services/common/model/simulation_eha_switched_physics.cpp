// The heavy half of simulation_eha_switched.cpp: with laws in force and injected columns.
#include "services/common/model/eha_switched_model.hpp"
#include "services/common/model/plant_physics.hpp"

namespace sealwatch {

template Result<SimulatedOutputs> PlantSimulationOf<EhaSwitchedModel>::run_with_physics(const RecordedInput&,
                                                                                        const ModelValues&,
                                                                                        std::span<const FreeQuantity>,
                                                                                        const SimulationOptions&,
                                                                                        InjectedColumns*) const;

}  // namespace sealwatch

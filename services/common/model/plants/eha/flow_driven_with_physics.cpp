// The heavy half of the simulation driven by the flow (circuit.cpp): with laws in force and injected columns.
#include "services/common/model/plant_physics.hpp"
#include "services/common/model/plants/eha/flow_driven_model.hpp"

namespace sealwatch {

template Result<SimulatedOutputs> PlantSimulationOf<EhaFlowDrivenModel>::run_with_physics(const RecordedInput&,
                                                                                          const ModelValues&,
                                                                                          std::span<const FreeQuantity>,
                                                                                          const SimulationOptions&,
                                                                                          InjectedColumns*) const;

}  // namespace sealwatch

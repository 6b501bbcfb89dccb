// The heavy half of circuit.cpp: with laws in force and injected columns.
#include "services/common/model/plant_physics.hpp"
#include "services/common/model/plants/eha/circuit_model.hpp"

namespace sealwatch {

template Result<SimulatedOutputs> PlantSimulationOf<EhaCircuitModel>::run_with_physics(const RecordedInput&,
                                                                                       const ModelValues&,
                                                                                       std::span<const FreeQuantity>,
                                                                                       const SimulationOptions&,
                                                                                       InjectedColumns*) const;

}  // namespace sealwatch

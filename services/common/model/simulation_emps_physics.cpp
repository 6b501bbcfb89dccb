// The heavy half of simulation_emps.cpp: with laws in force and injected columns.
#include "services/common/model/emps_model.hpp"
#include "services/common/model/plant_physics.hpp"

namespace sealwatch {

template Result<SimulatedOutputs> PlantSimulationOf<EmpsModel>::run_with_physics(const RecordedInput&,
                                                                                 const ModelValues&,
                                                                                 std::span<const FreeQuantity>,
                                                                                 const SimulationOptions&,
                                                                                 InjectedColumns*) const;

}  // namespace sealwatch

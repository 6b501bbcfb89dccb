// The heavy half of simulation_cascaded_tanks.cpp: with laws in force and injected columns.
#include "services/common/model/cascaded_tanks_model.hpp"
#include "services/common/model/plant_physics.hpp"

namespace sealwatch {

template Result<SimulatedOutputs> PlantSimulationOf<CascadedTanksModel>::run_with_physics(const RecordedInput&,
                                                                                          const ModelValues&,
                                                                                          std::span<const FreeQuantity>,
                                                                                          const SimulationOptions&,
                                                                                          InjectedColumns*) const;

}  // namespace sealwatch

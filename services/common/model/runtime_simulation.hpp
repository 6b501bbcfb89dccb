// PlantSimulation of a plant that is known at run time only (sealwatch/model/runtime_equations.hpp).
#pragma once

#include <memory>

#include "sealwatch/model/runtime_equations.hpp"
#include "services/common/model/recorded_input.hpp"
#include "services/common/model/recorded_simulation.hpp"

namespace sealwatch {

class RuntimePlantSimulation final : public RecordedSimulation {
 public:
  [[nodiscard]] static Result<std::unique_ptr<PlantSimulation>> create(std::shared_ptr<const RuntimePlant> plant,
                                                                       const PlantDescription& description,
                                                                       const AssetConfig& asset,
                                                                       const TimeSeries& recorded, PhysicsTerms terms);

  [[nodiscard]] std::span<const Site> sites() const override { return plant().sites; }

 private:
  [[nodiscard]] Result<SimulatedOutputs> run_driven_by(const RecordedInput& input, const ModelValues& values,
                                                       std::span<const FreeQuantity> free,
                                                       const SimulationOptions& options,
                                                       InjectedColumns* injected) const override;
  /// Sensitivities that events interrupt, by simulations with changed values.
  [[nodiscard]] Result<SimulatedOutputs> run_by_differences(const RecordedInput& input, const ModelValues& values,
                                                            std::span<const FreeQuantity> free,
                                                            const SimulationOptions& options) const;
  RuntimePlantSimulation(std::shared_ptr<const RuntimePlant> plant, const PlantDescription& description,
                         const TimeSeries& recorded, PhysicsTerms terms);

  std::shared_ptr<const RuntimePlant> runtime_;
};

}  // namespace sealwatch

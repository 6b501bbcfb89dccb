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
  [[nodiscard]] bool runs_elsewhere() const { return told_ != nullptr; }

  [[nodiscard]] Result<SimulatedOutputs> run_driven_by(const RecordedInput& input, const ModelValues& values,
                                                       std::span<const FreeQuantity> free,
                                                       const SimulationOptions& options,
                                                       InjectedColumns* injected) const override;

 private:
  /// Sensitivities that events interrupt, by simulations with changed values.
  [[nodiscard]] Result<SimulatedOutputs> run_by_differences(const RecordedInput& input, const ModelValues& values,
                                                            std::span<const FreeQuantity> free,
                                                            const SimulationOptions& options) const;
  RuntimePlantSimulation(std::shared_ptr<const RuntimePlant> plant, const PlantDescription& description,
                         const TimeSeries& recorded, PhysicsTerms terms);

  /// What equations that run elsewhere are told once.
  struct Told {
    AssetConfig asset;
    TimeSeries recorded;
    std::uint64_t number = 0;
  };
  std::shared_ptr<const RuntimePlant> runtime_;
  std::unique_ptr<const Told> told_;  ///< of those alone
};

/// Whether the simulation may jump where no input does: a unit that runs elsewhere has events of its own.
[[nodiscard]] bool may_jump(const PlantSimulation& simulation);

}  // namespace sealwatch

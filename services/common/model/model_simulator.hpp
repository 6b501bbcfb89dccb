// The port Simulator over PlantSimulation: free-run simulation of a recording with the asset's parameters, where only
// this recording's load factor and slow initial states are estimated.
#pragma once

#include "sealwatch/model/simulation.hpp"
#include "sealwatch/port/estimator.hpp"

namespace sealwatch {

class ModelSimulator final : public Simulator {
 public:
  [[nodiscard]] Result<TimeSeries> simulate(const AssetConfig& asset, const TimeSeries& recorded,
                                            const std::stop_token& cancel) const override;
};

/// Load factor and slow initial states that fit the recording best in the sense of least squares over the sensors'
/// noise; parameters stay. Gauss-Newton's method from simulation.start(), steps halved while they do not improve the
/// fit.
[[nodiscard]] Result<ModelValues> fit_operating_point(const PlantSimulation& simulation, const AssetConfig& asset,
                                                      const SimulationOptions& options = {});

}  // namespace sealwatch

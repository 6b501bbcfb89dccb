// Ports through which layers reach the heavy mathematics; implemented in services/common, injected by main.
#pragma once

#include <span>
#include <stop_token>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/core/result.hpp"
#include "sealwatch/core/time_series.hpp"
#include "sealwatch/estimation/fit_report.hpp"
#include "sealwatch/message/data_manipulation.hpp"

namespace sealwatch {

/// Gray-box prediction-error minimisation of one test.
class Estimator {
 public:
  virtual ~Estimator() = default;
  /// Every fit that the recorded channels allow, the one to trust first: the whole actuator where voltage, current and
  /// speed are recorded, the cylinder circuit where flow and pressures are. A fit that could not be made is a FitReport
  /// with admissible = false and the reasons. Deterministic; `cancel` ends it within a second, whatever it then returns.
  [[nodiscard]] virtual std::vector<FitReport> estimate(const AssetConfig& asset, const TimeSeries& samples,
                                                        std::span<const Phase> phases,
                                                        const std::stop_token& cancel) const = 0;
};

/// Simulation of the asset's model with given parameters, driven by the recorded input.
class Simulator {
 public:
  virtual ~Simulator() = default;
  /// Predicted channels at the recorded times, for each recorded output channel of the plant. Initial state and load
  /// factor are estimated from the recording, nothing else is. `cancel` ends it within a second, as an Error.
  [[nodiscard]] virtual Result<TimeSeries> simulate(const AssetConfig& asset, const TimeSeries& recorded,
                                                    const std::stop_token& cancel) const = 0;
};

}  // namespace sealwatch

// Residual of one test: simulation minus recording, channel by channel.
//
//   noise_normalised_rms = sqrt(mean(((y - y_hat) / sigma)^2))      1 is the floor
//   nrmse_percent        = 100 (1 - |y - y_hat| / |y - mean(y)|)
//
// Two references. nominal_model: the asset as its file has it. own_baseline: the same with the piston seal's resistance
// as this test's standstills show it, so that known ageing is not seen again in every channel (where they do not, as no
// flow is recorded, that with which the simulation comes nearest); state detection compares its rms with the asset's
// own first tests.
#pragma once

#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/core/result.hpp"
#include "sealwatch/message/data_manipulation.hpp"
#include "sealwatch/message/state_detection.hpp"
#include "sealwatch/port/estimator.hpp"

namespace sealwatch {

/// Summaries of all simulated channels that are recorded; those without noise figure or variation are left out.
[[nodiscard]] std::vector<ResidualSummary> summarise_residuals(const AssetConfig& asset, const TimeSeries& recorded,
                                                               const TimeSeries& simulated, Reference reference);

struct Residuals {
  std::vector<ResidualSummary> summaries;
  std::optional<double> nearest_wear;  ///< value of what wears with which the simulation comes nearest, where asked
};

/// Both references; an Error when the test cannot be simulated.
[[nodiscard]] Result<Residuals> residuals_of(const AssetConfig& asset, const TestWindow& window,
                                             std::optional<double> leakage_resistance, const Simulator& simulator,
                                             const std::stop_token& cancel);

/// Of the model that an operator accepted, with the piston seal's resistance as measured.
[[nodiscard]] Result<std::vector<ResidualSummary>> residuals_of_accepted(const AssetConfig& accepted,
                                                                         const TestWindow& window,
                                                                         std::optional<double> leakage_resistance,
                                                                         const Simulator& simulator,
                                                                         const std::stop_token& cancel);

}  // namespace sealwatch

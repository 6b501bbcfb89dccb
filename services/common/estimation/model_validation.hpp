// Validation of the process model: its simulation beside recordings, channel by channel (the source's section 4.1).
//
//   NRMSE fit, noise-normalised rms, Ljung-Box whiteness, independence of past input: residual_statistics.hpp
//   r_k = e_k / sigma    residual e = recorded - simulated over the noise of one sample
//   autocorrelation      rho_l = sum_k r_k r_(k-l) / sum_k r_k^2; white: within +-1.96/sqrt(n) at 95 % of the lags
//
// The simulation is driven by the recorded input and its initial state alone.
#pragma once

#include <string>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/core/recording.hpp"
#include "sealwatch/core/result.hpp"
#include "sealwatch/estimation/actuator_fit.hpp"
#include "sealwatch/estimation/fit_report.hpp"

namespace sealwatch {

inline constexpr std::size_t kAutocorrelationLags = 50;

struct ChannelValidation {
  ChannelFit fit;
  std::string unit;
  double noise_std = 0.0;  ///< of one sample; 0 when nobody knows: then only the NRMSE says something
  std::vector<double> recorded, simulated;
  std::vector<double> autocorrelation;  ///< from lag 0
};

struct RecordingValidation {
  std::string recording;
  std::vector<double> time_s;
  std::vector<ChannelValidation> channels;
};

struct ModelValidation {
  bool fitted = false;                         ///< parameters were estimated from these recordings
  std::vector<EstimatedParameter> parameters;  ///< as estimated, where they were
  std::string termination;                     ///< of the fit
  std::vector<RecordingValidation> recordings;
  /// Why the model is not the one that was recorded, by the limits of admissibility.hpp; empty: it may be.
  std::vector<std::string> reasons;
  /// What is more than noise although it is within those limits: a misfit above 1.3 times the noise, or residuals that
  /// are coloured or depend on the past input (1 % over all channels and recordings together).
  std::vector<std::string> remarks;
};

/// How a fit's search ends: a seal's leakage means nothing where the model does not come near the recording, and the
/// search is given up. Of a plant without a seal the question may be just how far its naive model is off; and one that
/// jumps is far off until all its jumps are met.
[[nodiscard]] ActuatorFitOptions search_of(const AssetConfig& asset);

/// Estimates the operating point of each recording (load and initial state) and nothing else; with `fit` the asset's
/// free parameters first, from all recordings together. An Error when a recording cannot be simulated.
[[nodiscard]] Result<ModelValidation> validate_model(const AssetConfig& asset, const std::vector<Recording>& recordings,
                                                     const std::vector<std::string>& names, bool fit);

}  // namespace sealwatch

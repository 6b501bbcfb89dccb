// Prediction-error minimisation of a whole plant: one or several recordings, shared parameters.
//
//   minimise over psi, Phi_k, x0_k:  1/2 sum_k sum_t sum_c ((y_ktc - y_hat_ktc(psi, Phi_k, x0_k)) / sigma_kc)^2
//   with psi_min <= psi <= psi_max
//
// psi: parameters that the asset marks `estimate`, positive ones as logarithms; Phi_k: load factor and x0_k: slow
// initial states of recording k, its own. sigma_kc: noise of channel c, as given or as seen in the data. y_hat: the
// simulation from the measured input alone (model/simulation.hpp), with its analytic sensitivities. The mean load phi
// is never free: each recording has its load factor, and only phi (1 + Phi_k) shows. Where phi is 0 (a plant without a
// mean load) phi itself is each recording's own load.
//
// Standard errors: (J'J)^-1 through singular values, so that what the data cannot tell has an infinite one; where the
// residuals are not white they are raised to the Newey-West sandwich (covariance.hpp), and `termination` says so.
// Interpolation: between samples the input is taken as linear. The error of that, estimated by leaving out every second
// sample (it falls with the square of the distance), is added to sigma.
#pragma once

#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/core/deadline.hpp"
#include "sealwatch/core/time_series.hpp"
#include "sealwatch/estimation/admissibility.hpp"
#include "sealwatch/estimation/fit_report.hpp"

namespace sealwatch {

struct ActuatorFitOptions {
  int maximum_iterations = 25;  ///< from nominal values five to eight are usual
  /// The search ends when an iteration changes the cost by less than this for each recording. 0.25 in cost is the step
  /// of a parameter by 0.7 standard errors; as each Gauss-Newton step is a small fraction of the one before, what is
  /// left after it is hundredths. The integrator's own error moves the cost by some tenths: less cannot be resolved.
  /// Where the misfit is above the noise, standard errors grow with it: this times the whitened misfit's mean square.
  double cost_tolerance = 0.25;
  /// Integrator steps per sample that a simulation may take. The reference plant needs 0.2 to 2.5 at its nominal
  /// values, the switched one 5, one with states as fast as its samples 10 to 20; a trial that needs more is far from
  /// any optimum and would only cost time: it counts as
  /// a failed step.
  double steps_per_sample = 20.0;
  /// A search whose whitened rms is still above this after some iterations is given up: the model is not that of the
  /// recording, and its parameters would mean nothing.
  double hopeless_rms = 20.0;
  /// Where the first search ends badly, the shared parameters are started again at these multiples of the asset's
  /// values.
  std::vector<double> restart_factors = {0.5, 2.0};
  bool cut_into_pieces = true;         ///< for a start, where the search from the asset's values does not converge
  int threads = 1;                     ///< recordings that are simulated at once
  const Deadline* deadline = nullptr;  ///< after which the best so far is reported, as not converged
  /// Is told what is done, and the share of the iterations of this search that are.
  std::function<void(std::string_view step, double share)> progress = {};
  AdmissibilityOptions admissibility;

  [[nodiscard]] Status validate() const;
};

/// What belongs to one recording of a joint fit.
struct RecordingFit {
  /// "load_factor", or "phi" where that is the recording's own; without a name where the plant has no load.
  EstimatedParameter load;
  std::vector<EstimatedParameter> initial_state;  ///< "initial:p_A", ...
  std::vector<ChannelFit> channels;
  TimeSeries simulated;  ///< recorded outputs as simulated, noise_std as used for whitening
};

struct JointFit {
  FitReport
      report;  ///< shared parameters; channels pooled over the recordings; parameters of its own for one recording
  std::vector<RecordingFit> recordings;  ///< empty when no fit could be made
};

/// Fits all recordings together. Never fails: what cannot be fitted is a report with admissible = false and the
/// reasons.
[[nodiscard]] JointFit fit_actuator(const AssetConfig& asset, std::span<const TimeSeries> recordings,
                                    const ActuatorFitOptions& options = {});

}  // namespace sealwatch

// What a prediction-error minimisation found. SI units. The field lists let a topic carry it as it is.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sealwatch/core/fields.hpp"

namespace sealwatch {

/// Fit quality of one channel.
struct ChannelFit {
  std::string channel;
  double noise_normalised_rms = 0.0;
  double nrmse_percent = 0.0;
  double whiteness_p = 0.0;     ///< Ljung-Box on the residual
  double independence_p = 0.0;  ///< residual against past input
  SEALWATCH_FIELDS(ChannelFit, channel, noise_normalised_rms, nrmse_percent, whiteness_p, independence_p)
  friend bool operator==(const ChannelFit&, const ChannelFit&) = default;
};

/// An estimated parameter with its bounds psi_min <= psi <= psi_max.
struct EstimatedParameter {
  std::string name;
  std::string unit;
  double value = 0.0;
  double std_error = 0.0;
  double min = 0.0;
  double max = 0.0;
  bool free = true;
  bool at_bound = false;
  SEALWATCH_FIELDS(EstimatedParameter, name, unit, value, std_error, min, max, free, at_bound)
  friend bool operator==(const EstimatedParameter&, const EstimatedParameter&) = default;
};

/// Result of one PEM run.
struct FitReport {
  std::string model;        ///< "cylinder_circuit", "eha", "eha_switched"
  std::string termination;  ///< why the optimiser stopped, in words
  bool converged = false;
  std::int32_t iterations = 0;
  double cost = 0.0;         ///< 1/2 sum of squared whitened residuals
  double load_factor = 0.0;  ///< Phi of this test
  std::vector<EstimatedParameter> parameters;
  std::vector<double> covariance;  ///< row-major, free parameters in the order of `parameters`
  std::vector<ChannelFit> channels;
  bool admissible = false;
  std::vector<std::string> reasons;  ///< why not admissible
  SEALWATCH_FIELDS(FitReport, model, termination, converged, iterations, cost, load_factor, parameters, covariance,
                   channels, admissible, reasons)
  friend bool operator==(const FitReport&, const FitReport&) = default;
};

}  // namespace sealwatch

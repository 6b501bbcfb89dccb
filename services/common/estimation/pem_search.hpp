// The search for the minimum of a PemProblem.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "sealwatch/estimation/actuator_fit.hpp"
#include "services/common/estimation/pem_problem.hpp"

namespace sealwatch {

/// Values of all unknowns.
struct PemPoint {
  std::vector<double> shared;
  std::vector<std::vector<double>> own;  ///< per recording
};

struct PemOptimum {
  PemPoint point;
  std::vector<Linearisation> at_optimum;  ///< per recording
  double cost = 0.0;
  double promised = 0.0;  ///< fall of the cost by the linear model where the search ended; infinite: not known
  bool converged = false;
  bool hopeless = false;      ///< given up far from the recording
  bool out_of_reach = false;  ///< given up as it cannot come to its bound (SearchBound)
  int iterations = 0;
  std::string termination;
};

/// The shared unknowns at `factor` times the asset's values, but for what is known beforehand; the recordings' own where
/// their simulations say.
[[nodiscard]] PemPoint start_point(const PemProblem& problem, double factor);

/// Integrator settings for recordings of this length.
[[nodiscard]] SimulationOptions simulation_options(std::span<const TimeSeries> recordings,
                                                   const ActuatorFitOptions& options);

/// From the asset's values, leakage and bulk modulus from the cylinder circuit where that can be fitted, else leakage
/// from the best of several values; from other values where that does not converge.
[[nodiscard]] Result<PemOptimum> search_from_asset(PemProblem& problem, const AssetConfig& asset,
                                                   std::span<const TimeSeries> recordings,
                                                   const ActuatorFitOptions& options);

/// What a search has to come to: it ends where its cost would stay above that, even if it fell by `optimism` times what
/// the linear model promises.
struct SearchBound {
  double cost = std::numeric_limits<double>::infinity();
  double optimism = 2.0;
  double decides_nothing = 0.0;  ///< share of the cost: a search whose linear model promises no more goes no further
  [[nodiscard]] bool is_out_of_reach(double from, double promised) const { return from - optimism * promised > cost; }
};

/// What is known before a search, where it is: linearisations at the start, derivatives near it, what to come to.
struct KnownBefore {
  std::vector<Linearisation> at_start = {};
  std::vector<KeptDerivatives> kept = {};
  SearchBound bound = {};
};

/// An Error when the simulation cannot even be run at the start.
[[nodiscard]] Result<PemOptimum> search(const PemProblem& problem, PemPoint start, const ActuatorFitOptions& options,
                                        KnownBefore known = {});

}  // namespace sealwatch

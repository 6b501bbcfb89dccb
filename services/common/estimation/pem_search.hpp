// The search for the minimum of a PemProblem with Ceres (bounded Levenberg-Marquardt).
#pragma once

#include <string>
#include <vector>

#include "sealwatch/estimation/actuator_fit.hpp"
#include "services/common/estimation/pem_problem.hpp"

namespace sealwatch {

struct PemOptimum {
  std::vector<double> shared;             ///< unknowns
  std::vector<std::vector<double>> own;   ///< unknowns, per recording
  std::vector<Linearisation> at_optimum;  ///< per recording
  double cost = 0.0;
  bool converged = false;
  int iterations = 0;
  std::string termination;
};

/// From the given start of the shared unknowns; the recordings' own start where their simulations say. An Error when
/// the simulation cannot even be run at the start.
[[nodiscard]] Result<PemOptimum> search(const PemProblem& problem, const std::vector<double>& shared_start,
                                        const ActuatorFitOptions& options);

}  // namespace sealwatch

// What a law contributes along a simulated recording, with the signals that it sees: for drawings and for regimes.
#pragma once

#include "services/common/mismatch/fitted_model.hpp"

namespace sealwatch::mismatch {

/// At the integrator's steps, in the order of time.
struct TermPath {
  std::vector<double> time_s;
  std::vector<std::array<double, kSiteSignals>> signals;  ///< of the element's first site of that kind
  std::vector<double> contribution;                       ///< 0 without a law
};

/// One recording at one point of the unknowns: what is simulated.
struct SimulatedPoint {
  const PemProblem* problem = nullptr;
  std::size_t recording = 0;
  std::span<const double> shared, own;
};
[[nodiscard]] SimulatedPoint point_of(const FittedModel& model, std::size_t recording);

/// Places of the plant of that element and kind.
[[nodiscard]] std::vector<std::size_t> sites_of(const PlantSimulation& simulation, std::string_view element,
                                                SiteKind kind);

/// Along the simulation, in steps of at most `longest_step_s`. `law` may be null; its parameters in their order. An
/// Error when the plant has no such site or cannot be simulated.
[[nodiscard]] Result<TermPath> term_path(const SimulatedPoint& at, const std::string& element, SiteKind kind,
                                         const Law* law, std::span<const double> parameters, double longest_step_s);

}  // namespace sealwatch::mismatch

// What a law contributes along a simulated recording, with the signals that it sees: for drawings and for regimes. Of a
// sensor's law: what its reading loses when the law is absent, all else equal, against what the sensor measures.
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

/// Of the sensor `element` ("sensor:flow") at the recorded samples: its first signal is the reading without the law.
[[nodiscard]] Result<TermPath> sensor_path(const SimulatedPoint& at, const std::string& element, const Law* law);

/// Index of the channel of "sensor:flow" or "flow" among the recorded ones, or their number.
[[nodiscard]] std::size_t channel_of(const PlantSimulation& simulation, const std::string& element);

/// Of every recording (window) that can be simulated at the model's estimates; empty paths of the others.
[[nodiscard]] std::vector<TermPath> term_paths(const FittedModel& with, const std::string& element, const Law& law,
                                               std::span<const double> parameters);

}  // namespace sealwatch::mismatch

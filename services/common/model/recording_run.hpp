// One run of a simulation over a recording: integration by segments of smooth input, sampling, sensors' low-passes and
// laws.
#pragma once

#include <span>
#include <string>
#include <utility>

#include "services/common/model/recorded_input.hpp"
#include "services/common/model/recorded_simulation.hpp"
#include "services/common/model/recorded_system.hpp"

namespace sealwatch {

/// `words`: of the equations themselves, with what to do about it.
inline Error went_no_further(std::string place, std::string words) {
  return {.file = {},
          .place = std::move(place),
          .value = std::move(words),
          .rule = "is why the simulation went no further",
          .advice = {}};
}

struct RecordingRunResult {
  Result<SimulatedOutputs> outputs;
  /// Whether an event ended the run that sensitivities do not cross; without columns it goes on.
  bool stopped_by_event = false;
};
[[nodiscard]] RecordingRunResult run_over_recording(const RecordedSimulation& simulation, const RecordedInput& input,
                                                    RecordedSystem& system, const ModelValues& values,
                                                    std::span<const FreeQuantity> free,
                                                    const SimulationOptions& options, const InjectedColumns* injected);

}  // namespace sealwatch

// Parts of a trial's plan besides its hidden physics: channels, tests, noise.
#pragma once

#include "services/verification/truth/trials.hpp"

namespace sealwatch::bench {

/// Standard deviation of a sample's noise of the reference model's sensors.
[[nodiscard]] double usual_noise(const std::string& channel);

/// The actuator with its hidden physics and sensors, under the test's load.
[[nodiscard]] TruthTest truth_test(const TrialPlan& plan, const PlannedTrialTest& planned);

struct GainAndBias {
  double gain = 1.0, bias = 0.0;
};
[[nodiscard]] GainAndBias fault_of(const TrialPlan& plan, const std::string& channel);

void choose_channels(TrialPlan& plan);
/// Profiles and loads of all tests. `own`: the set's own seed.
void choose_conditions(TrialPlan& plan, std::uint64_t own);
void choose_noise(TrialPlan& plan, std::uint64_t own);

/// Sets channels, the hidden physics and its twin.
void hide_inseparable(TrialPlan& plan, forecast::UniformRandom& random);
/// Sets channels and an effect that the free parameters swallow in nominal tests.
void hide_swallowed(TrialPlan& plan, forecast::UniformRandom& random);

}  // namespace sealwatch::bench

// Parts of a trial's plan besides its hidden physics: channels, tests, noise.
#pragma once

#include "services/virtual_bench/truth_trials.hpp"

namespace sealwatch::bench {

/// Standard deviation of a sample's noise of the reference model's sensors.
[[nodiscard]] double usual_noise(const std::string& channel);

void choose_channels(TrialPlan& plan);
/// Profiles and loads of all tests. `own`: the set's own seed.
void choose_conditions(TrialPlan& plan, std::uint64_t own);
void choose_noise(TrialPlan& plan, std::uint64_t own);

/// Puts one of two explanations into the plan that its channels and tests cannot tell apart.
void hide_inseparable(TrialPlan& plan, double times_barely);
/// A form of the listed effects by name, with shapes drawn from the seed.
[[nodiscard]] HiddenEffect effect_named(std::string_view id, std::string_view form, std::size_t side,
                                        double times_barely, std::uint64_t seed);

}  // namespace sealwatch::bench

// What a screening says of the laws, best first, with start values for their refits.
#pragma once

#include <vector>

#include "services/common/mismatch/refits.hpp"
#include "services/common/mismatch/screening.hpp"

namespace sealwatch::mismatch {

/// The law at that point of its grid, of these strengths (in its units).
[[nodiscard]] LawStart start_with(const Screening& screening, Variant variant, std::vector<double> strengths);

/// All variants that promise something, by their gain.
[[nodiscard]] std::vector<const Variant*> by_gain(const Screening& screening);

/// The screening of a model without those laws of sensors that promise too little to take half of what is left beyond the
/// noise, though the linear model, which is nearly exact for them, be off by kOptimistic: they take up some of whatever is
/// missing. The law that promises most stays, whatever it is.
[[nodiscard]] Screening causes_in(Screening screening, const FittedModel& model);

/// Best variants by gain, no law at the same element twice; with start values from the linear step. These are kept near
/// usual sizes, unless the model is known to answer `in_proportion`.
[[nodiscard]] std::vector<LawStart> ranked_laws(const Screening& screening, std::size_t most,
                                                bool in_proportion = false);

/// How many of the first `most` ranked laws promise nearly as much as the best, at least three: half as much, or less by
/// no more than twice what decides between models. None that promises less than `least`, but for the best.
[[nodiscard]] std::size_t nearly_as_promising(const Screening& screening, std::size_t most, double least = 0.0);

/// Of the best laws another point of their shape's grid: far from a recording the linearised gain says little about
/// where a refit ends, and from one start it may end in a local minimum beside the best.
[[nodiscard]] std::vector<LawStart> second_starts(const Screening& screening);

/// The best pairs of different laws that promise clearly more than the best single law. Without `also_measurements`
/// pairs of physics alone: what is off in sensors, the recorded input or the clock is asked beside the best law, where
/// sensors within their tolerances compete with it.
[[nodiscard]] std::vector<std::vector<LawStart>> ranked_pairs(const Screening& screening, double misfit,
                                                              bool also_measurements);

/// All parameters of a candidate at a point of its grid, strengths at their usual size.
[[nodiscard]] std::vector<double> usual_size(const Candidate& candidate, std::size_t point);

}  // namespace sealwatch::mismatch

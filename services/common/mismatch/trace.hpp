// What a search asked, in order, and what it saw beside what it claims.
//
//   score of a fitted model    criterion of the model as it is - its own, phi that of the best of all (criterion.hpp)
//   share of a candidate       d_j / (misfit - N) of the model as it is: what it would take of the excess by itself
//   probability                w_j / (w_0 + sum w),  w_j = exp(d_j / (2 phi))
//                              w_0 = exp((ln N + 12) / 2): nothing more
//
// d_j: gain of the law on the linearised final model (screening.hpp).
#pragma once

#include <vector>

#include "sealwatch/mismatch/explanation.hpp"
#include "services/common/mismatch/datasheet.hpp"
#include "services/common/mismatch/naming.hpp"

namespace sealwatch::mismatch {

[[nodiscard]] std::vector<Asked> trace_of(const Naming& naming);
/// Values of the asset file, with the laws that they leave standing, on the scale of the search beside which they were
/// asked.
[[nodiscard]] Asked asked(const WrongDatasheet& values, const Naming& beside);

/// Of `screening`, which is of `model`; `baseline`: the model as it is. Most probable first, at most eight.
[[nodiscard]] std::vector<CandidateCause> candidate_causes(const Screening& screening, const FittedModel& model,
                                                           const FittedModel& baseline);

}  // namespace sealwatch::mismatch

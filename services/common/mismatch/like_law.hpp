// Where a form starts in the place of a law that was found: with the parameters at which it does, along the simulated
// courses, most nearly what that law does there.
//
//   least over the form's shape of  |c - k f|^2 / |c|^2,   k = f'c / f'f
//
// c: what the law contributes along all recordings, weighed by the length of the steps; f: the form with a strength of 1.
#pragma once

#include <optional>
#include <vector>

#include "services/common/mismatch/candidates.hpp"
#include "services/common/mismatch/refits.hpp"
#include "services/common/mismatch/term_path.hpp"

namespace sealwatch::mismatch {

struct LikeLaw {
  std::vector<double> parameters;  ///< of the form
  double lacks = 1.0;              ///< share of the square of what the law does
};

/// `paths`: of the law, at its place in `model` (term_paths). Nothing where the form has a memory or several strengths,
/// acts elsewhere, or cannot do it within its bounds.
[[nodiscard]] std::optional<LikeLaw> most_like(const Candidate& form, const Effect& law,
                                               const std::vector<TermPath>& paths, const PlantDescription& plant);

}  // namespace sealwatch::mismatch

// Which laws: every single law and every pair on the linearised problem, then nonlinear refits of the best of them,
// law after law, at most three.
// docs/mismatch.md gives the thresholds with their reasons.
#pragma once

#include <memory>
#include <vector>

#include "sealwatch/mismatch/explain.hpp"
#include "services/common/mismatch/criterion.hpp"
#include "services/common/mismatch/screening.hpp"

namespace sealwatch::mismatch {

/// A law at an element that was added, or could be.
struct Effect {
  const Law* law = nullptr;
  std::string element;
};

/// The model refitted with some laws.
struct Trial {
  std::vector<Effect> effects;
  std::shared_ptr<const FittedModel> model;
};

/// An improvement that physics forbids.
struct Forbidden {
  Effect effect;
  double strength = 0.0;  ///< what the data would want
  double score = 0.0;
};

struct Naming {
  std::shared_ptr<const FittedModel> baseline;
  Trial best;                 ///< effects may be empty
  std::vector<Trial> trials;  ///< all that were refitted, the best among them
  Screening first;            ///< of the baseline
  Screening last;             ///< of the best model
  std::vector<Forbidden> forbidden = {};
};

[[nodiscard]] Result<Naming> name_effects(std::shared_ptr<const FittedModel> baseline, const Data& data,
                                          const ExplainOptions& options, const Progress& progress);

/// Refits of `laws` (each with its start values) added to `from`, on `threads` threads; those that fail are left out.
struct LawStart {
  Effect effect;
  std::vector<double> parameters;
};
[[nodiscard]] std::vector<Trial> refit(const Trial& from, const std::vector<std::vector<LawStart>>& laws,
                                       const Data& data, int threads);

/// A search that ran out of iterations goes on from where it is.
[[nodiscard]] Trial polished(Trial trial, const Data& data, int threads);

/// Best variants by gain, no law at the same element twice; with start values from the linear step.
[[nodiscard]] std::vector<LawStart> ranked_laws(const Screening& screening, std::size_t most);

}  // namespace sealwatch::mismatch

// The verdict as a table of what was found:
//
//   no law is named, for a reason that was found     undetermined
//   no difference beyond the noise                   consistent; undetermined where a law that matters could hide, or
//                                                    a model could not be simulated on some recording
//   a difference                                     mismatch where laws are proven and explain it, else undetermined
//
// Laws explain where they are proven and leave nothing, take at least half of the misfit's excess over the noise, or
// leave at most a tenth of the evidence, -ln p: the noise's own estimate is not exact enough for the first two alone
// where the effect is small. Of a plant whose inside cannot be asked they explain where no gross misfit stays: clocks,
// sensors and inputs take up some of whatever is missing within.
#pragma once

#include "sealwatch/mismatch/explanation.hpp"

namespace sealwatch::mismatch {

inline constexpr double kExplainedAtLeast = 0.5;  ///< of the excess misfit, before a mismatch counts as explained
inline constexpr double kEvidenceLeft = 0.1;      ///< of the evidence against the model, or so much left
inline constexpr double kSmallestP = 1e-300;      ///< that is told: the tail's own digits end there

/// Of the misfit above the noise, by the mean square of whitened residuals before and after; 0 to 1.
[[nodiscard]] double share_explained(double before, double after);

/// What is known of the laws that are claimed.
struct LawsFound {
  bool any = false;
  bool proven = false;                ///< on recordings that took no part
  bool leave_nothing = false;         ///< beyond the noise
  double share = 0.0;                 ///< share_explained
  double share_held_out = 1.0;        ///< the same of held-out recordings, where laws alone decide it
  bool leave_what_is_within = false;  ///< a gross misfit, where physics within the plant cannot be asked
  bool as_searched = false;           ///< all that the search ended with: `p_after` is then theirs
  double p_before = 1.0, p_after = 1.0;
  bool leave_gross_misfit = false;  ///< seen without any law, whatever p_after
};

[[nodiscard]] bool explains(const LawsFound& laws);

struct Findings {
  bool no_law_for_a_reason = false;
  bool differs = false;          ///< beyond the noise
  bool something_hides = false;  ///< a law of a size that matters, in the free parameters
  bool all_compared = true;      ///< the models can be simulated on every recording
  bool explained = false;
};

[[nodiscard]] Verdict verdict_of(const Findings& findings);

}  // namespace sealwatch::mismatch

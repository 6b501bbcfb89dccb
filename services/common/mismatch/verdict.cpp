#include "services/common/mismatch/verdict.hpp"

#include <algorithm>
#include <cmath>

namespace sealwatch::mismatch {
namespace {

// -ln p, to the smallest p that a double holds.
double evidence(double p_value) { return -std::log(std::max(p_value, kSmallestP)); }

}  // namespace

double share_explained(double before, double after) {
  const double excess = before - 1.0, left = std::max(after - 1.0, 0.0);
  return excess > 0.0 ? std::clamp(1.0 - left / excess, 0.0, 1.0) : 0.0;
}

bool explains(const LawsFound& laws) {
  if (!laws.any || !laws.proven || laws.leave_what_is_within) return false;
  const bool little_evidence_left =
      laws.as_searched && !laws.leave_gross_misfit && evidence(laws.p_after) <= kEvidenceLeft * evidence(laws.p_before);
  return laws.leave_nothing || std::min(laws.share, laws.share_held_out) >= kExplainedAtLeast || little_evidence_left;
}

Verdict verdict_of(const Findings& findings) {
  if (findings.no_law_for_a_reason) return Verdict::undetermined;
  if (findings.differs) return findings.explained ? Verdict::mismatch : Verdict::undetermined;
  return findings.something_hides || !findings.all_compared ? Verdict::undetermined : Verdict::consistent;
}

}  // namespace sealwatch::mismatch

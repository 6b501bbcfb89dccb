// Which of the laws found prove themselves on recordings that took no part in their fit. Together they predict these
// beyond doubt better than the model without them, and each of them better than the others alone: near the noise by what
// is likeliest, as the fit told each law beyond doubt; in a gross misfit, where a fit tells little, beyond doubt. What
// does not is taken back, the law that helps least first. In a gross misfit the explanation is chosen that carries over.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "services/common/mismatch/carry_over.hpp"
#include "services/common/mismatch/held_out.hpp"
#include "services/common/mismatch/naming.hpp"
#include "services/common/mismatch/time_budget.hpp"

namespace sealwatch::mismatch {

/// Of an analysis that outlives it.
struct ToProve {
  HeldOut held_out;
  Naming& naming;  ///< keeps the models without one law that are fitted
  std::shared_ptr<const FittedModel> baseline;
  std::vector<KnownValue> sensors = {};  ///< that were taken for exact: what each may be off by
};

struct ProvenLaws {
  Trial best;  ///< what is left of the laws
  bool proven = false;
  std::vector<std::string> notes;         ///< on what was taken back
  std::vector<std::string> not_compared;  ///< recordings on which a model cannot be simulated
};

[[nodiscard]] ProvenLaws prove(const ToProve& of, Trial best, TimeBudget& time);

/// An explanation without one of its laws (without_law); none of them where the others cannot be fitted.
[[nodiscard]] Trial without(const Trial& trial, std::size_t slot, const ToProve& of);

/// How explanations carry over to these recordings.
[[nodiscard]] CarryOver carry_over_of(const ToProve& of, const HeldOut& held_out);

}  // namespace sealwatch::mismatch

// One set of the blind trial: recorded in memory, given to the analysis and to the controls.
#pragma once

#include "services/verification/trial/mismatch_record.hpp"
#include "services/verification/truth/trials.hpp"

namespace sealwatch::verification {

struct TrialOptions {
  bool controls = true;
  int threads = 1;  ///< within a set
};

/// Never fails: what goes wrong is the record's `error`.
[[nodiscard]] MismatchRecord run_trial(const bench::TrialPlan& plan, const TrialOptions& options);

}  // namespace sealwatch::verification

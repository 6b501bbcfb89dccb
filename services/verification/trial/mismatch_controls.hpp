// What other methods say of the same set:
//   chi-square   misfit of the refitted model against its degrees of freedom: detects, names nothing
//   BIC          the single law with the lowest misfit + k ln N, no colour and no long-run factor
//   sparse       sparse regression on smoothed states (sparse_regression.hpp): its term of the largest gain
//   oracle       refit with the true laws (nearest form of the catalogue, or closed form without a name) given: the
//                best that could be reached
// and how much of the truth the free parameters absorb, on these tests and on the nominal ones alone.
#pragma once

#include "services/verification/trial/mismatch_record.hpp"
#include "services/verification/truth/trials.hpp"

namespace sealwatch::verification {

[[nodiscard]] ControlRecord run_controls(const AssetConfig& asset, const bench::TrialRecordings& recordings,
                                         const bench::TrialPlan& plan, int threads);

}  // namespace sealwatch::verification

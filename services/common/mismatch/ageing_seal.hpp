// A seal that ages while physics is missing: each recording keeps a leakage resistance R_CL of its own, and laws are
// asked for beside it, beginning with those that were found in common. That model must be likelier than theirs by the
// rule of between_tests.hpp (a parameter more for each recording) and 12 more, and R_CL must fall from recording to
// recording: wear does not heal. Only tests of different days are asked: within one a seal does not age.
#pragma once

#include <optional>
#include <string>

#include "services/common/mismatch/naming.hpp"

namespace sealwatch::mismatch {

/// The recordings, each with its own R_CL, and what is missing beside that.
struct AgeingSeal {
  Data fit, holdout;
  std::shared_ptr<const FittedModel> baseline;
  Naming naming;
};

/// Nothing where `common`, the best that was found with one R_CL for all of them, is as likely. `baseline`: the model
/// without any law, likewise.
[[nodiscard]] std::optional<AgeingSeal> with_ageing_seal(const Data& fit, const Data& holdout,
                                                         const FittedModel& baseline, const Trial& common,
                                                         const ExplainOptions& options, const Progress& progress);

/// "The piston seal aged between these tests: R_CL is ...", value by value.
[[nodiscard]] std::string ageing_in_words(const FittedModel& model, const Data& fit);

}  // namespace sealwatch::mismatch

// A seal that ages while physics is missing: each fitted recording keeps a leakage resistance R_CL of its own, and laws
// are asked for beside it, beginning with those that were found in common. Only tests of different days are asked:
// within one a seal does not age. By the criterion of the fitted recordings (criterion.hpp), with a parameter more for
// each,
//
//   with fewer laws it is preferred unless those that it does without are worth 12 each, as any law must be
//   with as many it must be better by 12
//
// Recordings that took no part have the R_CL that its course in the others predicts for their dates: ln R_CL is taken
// as linear in time between two tests, and goes on as it ended.
#pragma once

#include <optional>
#include <string>

#include "services/common/mismatch/naming.hpp"

namespace sealwatch::mismatch {

/// The fitted recordings, each with its own R_CL, and what is missing beside that.
struct AgeingSeal {
  Data fit;
  std::shared_ptr<const FittedModel> baseline;
  Naming naming;
  bool wears = false;  ///< R_CL falls from test to test, as wear does not heal; else something else changed
};

/// Whether the tests are of different days, and the asset's R_CL is estimated: within one day a seal does not age.
[[nodiscard]] bool may_age(const AssetConfig& asset, const Data& fit);

/// The fitted recordings, each with its own R_CL, where that alone explains everything: R_CL falls from test to test and nothing differs beyond the noise any
/// more. Asked before any law: tests of different months differ by wear, laws in common would bend to it.
[[nodiscard]] std::optional<AgeingSeal> nothing_but_ageing(const Data& fit,
                                                           const std::shared_ptr<const FittedModel>& baseline,
                                                           const ExplainOptions& options);

/// Nothing where `common`, the best that was found with one R_CL for all of them, is preferred, or where R_CL does not
/// differ by far more than its standard errors. `baseline`: the model without any law, likewise.
[[nodiscard]] std::optional<AgeingSeal> with_ageing_seal(const Data& fit, const FittedModel& baseline,
                                                         const Trial& common, const ExplainOptions& options,
                                                         const Progress& progress);

/// R_CL at a time [Pa s/m3] by its course in `fit`, to which `model` was fitted; the latest where the time is not
/// known.
[[nodiscard]] double predicted_leakage(const FittedModel& model, const Data& fit, std::optional<UtcTime> time);

/// "From test to test R_CL is ...", value by value.
[[nodiscard]] std::string ageing_in_words(const FittedModel& model, const Data& fit);

}  // namespace sealwatch::mismatch

// A seal that ages while physics is missing. Laws that all tests have in common bend to what ageing does, so each fitted
// recording first has a leakage resistance R_CL of its own, and laws are asked for beside it; then in common, beginning
// with those. Only tests of different days are asked: within one a seal does not age. By the criterion of the fitted recordings (criterion.hpp), with a parameter more for each,
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

/// The model without laws and with an R_CL for each recording, which has not been searched yet; nothing where it cannot
/// be fitted. How far the values lie apart is not asked yet: what is missing makes their standard errors large.
[[nodiscard]] std::optional<AgeingSeal> each_its_own_seal(const Data& fit, const FittedModel& baseline, int threads);

/// Laws beside it; whether the seal wears is known then.
[[nodiscard]] Status look_beside(AgeingSeal& seal, const ExplainOptions& options, const Progress& progress);

/// Whether nothing is left beyond the noise by a seal that wears and the laws beside it, or no more than the exact form of
/// the only one.
[[nodiscard]] bool explains_everything(const AgeingSeal& seal, const ExplainOptions& options);

/// Whether R_CL differs by far more than its standard errors, and the best with one for each recording is preferred to
/// the best in common.
[[nodiscard]] bool is_preferred(const AgeingSeal& seal, const Trial& common);

/// The laws found beside it with one R_CL for all recordings of `fit`; nothing where that cannot be fitted.
[[nodiscard]] std::optional<Trial> in_common(const AgeingSeal& seal, const Data& fit, int threads);

/// R_CL at a time [Pa s/m3] by its course in `fit`, to which `model` was fitted; the latest where the time is not
/// known.
[[nodiscard]] double predicted_leakage(const FittedModel& model, const Data& fit, std::optional<UtcTime> time);

/// "The piston seal": what wears in the asset.
[[nodiscard]] std::string what_aged(const AssetConfig& asset);

/// "From test to test R_CL is ...", value by value.
[[nodiscard]] std::string ageing_in_words(const FittedModel& model, const Data& fit);

}  // namespace sealwatch::mismatch

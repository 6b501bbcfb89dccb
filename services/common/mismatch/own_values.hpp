// A parameter that differs from test to test while physics is missing. Laws that all tests have in common bend to what it
// does, so each fitted recording has a value of its own, and laws are asked for beside it; then in common, beginning
// with those. Only tests that are not known to be of one day are asked.
//
//   wear        what ages (R_CL), in tests of several days: asked before any law
//   others      asked in every round of the search beside the laws (naming.hpp)
//
// By the criterion of the fitted recordings (criterion.hpp), with a parameter more for each:
//
//   wear, with fewer laws, is preferred unless those that it does without are worth 12 each, as any law must be
//   else it must be better by 12
//
// Recordings that took no part have the value that the course of wear in the others predicts for their dates: ln R_CL is
// taken as linear in time between two tests, and goes on as it ended. Any other parameter is fitted to them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/common/mismatch/naming.hpp"

namespace sealwatch::mismatch {

/// The fitted recordings, each with its own value of one parameter, and what is missing beside that.
struct OwnValues {
  Data fit;  ///< names the parameter (Data::own_parameter)
  std::shared_ptr<const FittedModel> baseline;
  Naming naming;
  /// What ages goes one way from test to test, as wear does not heal; else something else changed. Other parameters go
  /// any way.
  bool goes_its_way = false;
};

/// Whether the tests are of different days, and what wears is estimated: within one day a seal does not age.
[[nodiscard]] bool may_age(const AssetConfig& asset, const Data& fit);

/// Estimated parameters that may differ from recording to recording, beside what wears.
[[nodiscard]] std::vector<std::string> may_differ(const AssetConfig& asset, const Data& fit);

/// The parameter by which the asset wears: "R_CL".
[[nodiscard]] std::string what_wears(const AssetConfig& asset);

/// The model without laws and with a value of `parameter` for each recording, which has not been searched yet; nothing
/// where it cannot be fitted. How far the values lie apart is not asked yet: what is missing makes their standard
/// errors large.
[[nodiscard]] std::optional<OwnValues> each_its_own(const std::string& parameter, const Data& fit,
                                                    const FittedModel& baseline, int threads);

/// Laws beside it, beginning with `from`; whether what wears goes its way is known then.
[[nodiscard]] Status look_beside(OwnValues& own, const ExplainOptions& options, const Progress& progress,
                                 const Trial& from = {});

/// Whether nothing is left beyond the noise by wear and the laws beside it, or no more than the exact form of the only
/// one.
[[nodiscard]] bool explains_everything(const OwnValues& own, const ExplainOptions& options);

/// Whether the values differ by far more than their standard errors, and the best with one for each recording is preferred
/// to the best in common.
[[nodiscard]] bool is_preferred(const OwnValues& own, const Trial& common);

/// The laws found beside it with one value for all recordings; nothing where that cannot be fitted.
[[nodiscard]] std::optional<Trial> in_common(const OwnValues& own, int threads);

/// Laws found elsewhere, with a value for each recording; none where there are none or that cannot be fitted.
[[nodiscard]] Trial with_own_values(const Trial& found, const OwnValues& own, int threads);

/// R_CL at a time [Pa s/m3] by its course in `fit`, to which `model` was fitted; the latest where the time is not
/// known.
[[nodiscard]] double predicted_leakage(const FittedModel& model, const Data& fit, std::optional<UtcTime> time);

/// Whether it is what wears.
[[nodiscard]] bool is_wear(const OwnValues& own);

/// "piston seal": what wears in the asset.
[[nodiscard]] std::string worn_part(const AssetConfig& asset);
/// The element that it is of the plant; "" where a plant as text does not say it.
[[nodiscard]] std::string worn_element(const AssetConfig& asset);

/// "From test to test R_CL is ...", value by value.
[[nodiscard]] std::string course_in_words(const FittedModel& model, const Data& fit);

}  // namespace sealwatch::mismatch

#include "services/common/mismatch/ageing_seal.hpp"

#include <algorithm>
#include <cmath>

#include "services/common/mismatch/between_tests.hpp"
#include "services/common/mismatch/standard_errors.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kFalls = 3.0;  // standard errors by which a value may lie above the one before it
constexpr const char* kSealLeakage = "R_CL";

// Whether the seal's leakage is estimated, and the recordings, which are in the order of time, are of several days.
bool may_age(const AssetConfig& asset, const Data& fit) {
  const auto leakage = asset.parameters.find(kSealLeakage);
  if (leakage == asset.parameters.end() || !leakage->second.estimate || fit.start_time.size() < 2) return false;
  if (!std::ranges::all_of(fit.start_time, [](const auto& time) { return time.has_value(); })) return false;
  return seconds_between(*fit.start_time.front(), *fit.start_time.back()) > kSecondsPerDay;
}

Course seal_course(const FittedModel& model, const Data& fit) {
  const std::vector<double> errors = standard_errors(model);
  Course course;
  for (std::size_t k = 0; k < model.problem.shared.size(); ++k) {
    const Unknown& unknown = model.problem.shared[k];
    if (unknown.group < 0 || parameter_of(unknown) != kSealLeakage) continue;
    course.unit = unknown.unit;
    course.values.push_back({.when = date_or_name(fit, static_cast<std::size_t>(unknown.group)),
                             .value = unknown.to_value(model.optimum.point.shared[k]),
                             .std_error = errors[k]});
  }
  return course;
}

// Whether R_CL falls from recording to recording, by far more than its standard errors.
bool ages(const FittedModel& model, const Data& fit) {
  const Course course = seal_course(model, fit);
  if (course.values.size() < 2) return false;
  for (std::size_t k = 0; k < course.values.size(); ++k) {
    if (!std::isfinite(course.values[k].std_error)) return false;
    if (k > 0 && course.values[k].value - course.values[k - 1].value >
                     kFalls * std::hypot(course.values[k].std_error, course.values[k - 1].std_error))
      return false;
  }
  return course.values.front().value > course.values.back().value && course.standard_errors() >= kChanged;
}

bool is_likelier(const FittedModel& ageing, const Data& ageing_holdout, const FittedModel& common,
                 const Data& common_holdout) {
  const std::optional<Misfit> own = misfit_in_common(ageing, ageing_holdout);
  const std::optional<Misfit> shared = misfit_in_common(common, common_holdout);
  if (!own || !shared) return own.has_value();
  const double phi = std::max(1.0, std::min(own->sum, shared->sum) / own->residuals);
  return own->criterion(phi) < shared->criterion(phi) - kWorthAnother;
}

}  // namespace

std::optional<AgeingSeal> with_ageing_seal(const Data& fit, const Data& holdout, const FittedModel& baseline,
                                           const Trial& common, const ExplainOptions& options,
                                           const Progress& progress) {
  if (!may_age(baseline.asset, fit)) return std::nullopt;
  AgeingSeal seal{.fit = fit, .holdout = holdout, .baseline = nullptr, .naming = {}};
  seal.fit.own_parameter = seal.holdout.own_parameter = kSealLeakage;
  Result<FittedModel> with_laws = fit_model(common.model->asset, seal.fit, common.model.get(), options.threads);
  if (!with_laws || !is_likelier(*with_laws, seal.holdout, *common.model, holdout)) return std::nullopt;
  Result<FittedModel> without = fit_model(baseline.asset, seal.fit, &baseline, options.threads);
  if (!without) return std::nullopt;
  if (progress) progress("asking again, with a seal that ages between the tests", 0.5);
  seal.baseline = std::make_shared<const FittedModel>(std::move(*without));
  const Trial from{common.effects, std::make_shared<const FittedModel>(std::move(*with_laws))};
  Result<Naming> naming = name_effects(seal.baseline, seal.fit, options, progress, from);
  if (!naming || !ages(*naming->best.model, seal.fit) ||
      !is_likelier(*naming->best.model, seal.holdout, *common.model, holdout))
    return std::nullopt;
  seal.naming = std::move(*naming);
  return seal;
}

std::string ageing_in_words(const FittedModel& model, const Data& fit) {
  return "The piston seal aged between these tests: R_CL is " + seal_course(model, fit).in_words() + ".";
}

}  // namespace sealwatch::mismatch

#include "services/common/mismatch/ageing_seal.hpp"

#include <algorithm>
#include <cmath>

#include "services/common/mismatch/between_tests.hpp"
#include "services/common/mismatch/standard_errors.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kFalls = 3.0;  // standard errors by which a value may lie above the one before it

const PlantDescription& plant_of(const AssetConfig& asset) { return **find_plant(asset.model); }

std::string what_wears(const AssetConfig& asset) {
  return asset.condition ? asset.condition->parameter : plant_of(asset).wear_parameter;
}

Course seal_course(const FittedModel& model, const Data& fit) {
  const std::vector<double> errors = standard_errors(model);
  Course course;
  for (std::size_t k = 0; k < model.problem.shared.size(); ++k) {
    const Unknown& unknown = model.problem.shared[k];
    if (unknown.group < 0 || parameter_of(unknown) != fit.own_parameter) continue;
    course.unit = unknown.unit;
    course.values.push_back({.when = date_or_name(fit, static_cast<std::size_t>(unknown.group)),
                             .value = unknown.to_value(model.optimum.point.shared[k]),
                             .std_error = errors[k]});
  }
  return course;
}

// Wear goes one way: that of the anchors, where they are known.
bool wears(const Course& course, const AssetConfig& asset) {
  const std::optional<ConditionSetting> scale = asset.condition ? asset.condition : plant_of(asset).condition;
  const double first = course.values.front().value, last = course.values.back().value;
  const double way = (scale ? scale->at_60 < scale->at_100 : last < first) ? -1.0 : 1.0;
  for (std::size_t k = 1; k < course.values.size(); ++k)
    if (-way * (course.values[k].value - course.values[k - 1].value) >
        kFalls * std::hypot(course.values[k].std_error, course.values[k - 1].std_error))
      return false;
  return way * last > way * first;
}

bool is_preferred(const Trial& ageing, const Trial& common) {
  const double phi = std::min(dispersion(*ageing.model), dispersion(*common.model));
  const auto fewer = static_cast<double>(common.effects.size()) - static_cast<double>(ageing.effects.size());
  const double ahead = criterion(*common.model, phi) - criterion(*ageing.model, phi);
  return ahead > (fewer > 0.0 ? -fewer * kWorthAnother : kWorthAnother);
}

// It differs from test to test by far more than its standard errors, each of which is known.
bool changes(const Course& course) {
  const bool known = std::ranges::all_of(course.values, [](const auto& one) { return std::isfinite(one.std_error); });
  return known && course.standard_errors() >= kChanged;
}

}  // namespace

bool may_age(const AssetConfig& asset, const Data& fit) {
  const auto leakage = asset.parameters.find(what_wears(asset));
  return leakage != asset.parameters.end() && leakage->second.estimate && are_of_several_days(fit);
}

std::optional<AgeingSeal> each_its_own_seal(const Data& fit, const FittedModel& baseline, int threads) {
  AgeingSeal seal{.fit = fit, .baseline = nullptr, .naming = {}};
  seal.fit.own_parameter = what_wears(baseline.asset);
  Result<FittedModel> model = fit_model(baseline.asset, seal.fit, &baseline, threads);
  if (!model) return std::nullopt;
  seal.baseline = std::make_shared<const FittedModel>(std::move(*model));
  return seal;
}

Status look_beside(AgeingSeal& seal, const ExplainOptions& options, const Progress& progress) {
  Result<Naming> naming = name_effects(seal.baseline, seal.fit, options, progress);
  if (!naming) return fail(naming.error());
  seal.naming = std::move(*naming);
  seal.wears = wears(seal_course(*seal.naming.best.model, seal.fit), seal.baseline->asset);
  return {};
}

bool explains_everything(const AgeingSeal& seal, const ExplainOptions& options) {
  const FittedModel& best = *seal.naming.best.model;
  const bool no_more =
      !differs(seal.naming.last.p_value, best, options.false_alarm_rate) || leaves_its_form(seal.naming);
  return seal.wears && changes(seal_course(best, seal.fit)) && no_more;
}

bool is_preferred(const AgeingSeal& seal, const Trial& common) {
  return changes(seal_course(*seal.naming.best.model, seal.fit)) && is_preferred(seal.naming.best, common);
}

std::optional<Trial> in_common(const AgeingSeal& seal, const Data& fit, int threads) {
  const Trial& best = seal.naming.best;
  Result<FittedModel> model = fit_model(best.model->asset, fit, best.model.get(), threads);
  if (!model) return std::nullopt;
  return Trial{best.effects, std::make_shared<const FittedModel>(std::move(*model))};
}

double predicted_leakage(const FittedModel& model, const Data& fit, std::optional<UtcTime> time) {
  const Course course = seal_course(model, fit);
  const std::size_t last = course.values.size() - 1;
  if (!time || last == 0) return course.values.back().value;
  std::size_t next = 1;  // end of the interval that the time lies in, or of the nearest
  while (next < last && *fit.start_time[next] < *time) ++next;
  const double interval_s = seconds_between(*fit.start_time[next - 1], *fit.start_time[next]);
  const double share = interval_s > 0.0 ? seconds_between(*fit.start_time[next - 1], *time) / interval_s : 1.0;
  const double before = course.values[next - 1].value, after = course.values[next].value;
  if (!(before > 0.0 && after > 0.0)) return before + share * (after - before);
  return before * std::pow(after / before, share);
}

std::string what_aged(const AssetConfig& asset) {
  const std::optional<ConditionSetting> scale = asset.condition ? asset.condition : plant_of(asset).condition;
  return "The " + (scale && !scale->part.empty() ? scale->part : "part whose " + what_wears(asset) + " wears");
}

std::string ageing_in_words(const FittedModel& model, const Data& fit) {
  return "From test to test " + fit.own_parameter + " is " + seal_course(model, fit).in_words() + ".";
}

}  // namespace sealwatch::mismatch

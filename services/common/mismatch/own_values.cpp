#include "services/common/mismatch/own_values.hpp"

#include <algorithm>
#include <cmath>

#include "services/common/mismatch/between_tests.hpp"
#include "services/common/mismatch/standard_errors.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kFalls = 3.0;  // standard errors by which a value may lie above the one before it

const PlantDescription& plant_of(const AssetConfig& asset) { return **find_plant(asset.model); }

// The unknowns that each recording has for itself.
std::vector<std::size_t> own_unknowns(const FittedModel& model, const Data& fit) {
  std::vector<std::size_t> own;
  for (std::size_t k = 0; k < model.problem.shared.size(); ++k)
    if (model.problem.shared[k].group >= 0 && parameter_of(model.problem.shared[k]) == fit.own_parameter)
      own.push_back(k);
  return own;
}

Course course_of(const FittedModel& model, const Data& fit) {
  const std::vector<double> errors = standard_errors(model);
  Course course;
  for (const std::size_t k : own_unknowns(model, fit)) {
    const Unknown& unknown = model.problem.shared[k];
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

bool is_preferred(const Trial& own, const Trial& common, bool by_wear) {
  const double phi = std::min(dispersion(*own.model), dispersion(*common.model));
  const auto fewer = static_cast<double>(common.effects.size()) - static_cast<double>(own.effects.size());
  const double ahead = criterion(*common.model, phi) - criterion(*own.model, phi);
  return ahead > (by_wear && fewer > 0.0 ? -fewer * kWorthAnother : kWorthAnother);
}

// It differs from test to test by far more than the standard errors of the differences.
bool changes(const OwnValues& own) {
  const FittedModel& model = *own.naming.best.model;
  return standard_errors_apart(model, own_unknowns(model, own.fit)) >= kChanged;
}

// The same laws, fitted to other data.
std::optional<Trial> again_with(const Trial& laws, const Data& data, int threads) {
  Result<FittedModel> model = fit_model(laws.model->asset, data, laws.model.get(), threads);
  if (!model) return std::nullopt;
  return Trial{laws.effects, std::make_shared<const FittedModel>(std::move(*model))};
}

}  // namespace

std::string what_wears(const AssetConfig& asset) {
  return asset.condition ? asset.condition->parameter : plant_of(asset).wear_parameter;
}

bool may_age(const AssetConfig& asset, const Data& fit) {
  const auto leakage = asset.parameters.find(what_wears(asset));
  return leakage != asset.parameters.end() && leakage->second.estimate && are_of_several_days(fit);
}

std::vector<std::string> may_differ(const AssetConfig& asset, const Data& fit) {
  std::vector<std::string> parameters;
  if (fit.samples.size() < 2 || are_of_one_day(fit)) return parameters;
  for (const auto& [name, setting] : asset.parameters)
    if (setting.estimate && name != what_wears(asset) && name != plant_of(asset).load_parameter)
      parameters.push_back(name);
  return parameters;
}

std::optional<OwnValues> each_its_own(const std::string& parameter, const Data& fit, const FittedModel& baseline,
                                      int threads) {
  OwnValues own{.fit = fit, .baseline = nullptr, .naming = {}};
  own.fit.own_parameter = parameter;
  Result<FittedModel> model = fit_model(baseline.asset, own.fit, &baseline, threads);
  if (!model) return std::nullopt;
  own.baseline = std::make_shared<const FittedModel>(std::move(*model));
  return own;
}

Status look_beside(OwnValues& own, const ExplainOptions& options, const Progress& progress, const Trial& from) {
  Result<Naming> naming = name_effects(own.baseline, own.fit, options, progress, from);
  if (!naming) return fail(naming.error());
  own.naming = std::move(*naming);
  own.goes_its_way = !is_wear(own) || wears(course_of(*own.naming.best.model, own.fit), own.baseline->asset);
  return {};
}

bool explains_everything(const OwnValues& own, const ExplainOptions& options) {
  const FittedModel& best = *own.naming.best.model;
  const bool no_more = !differs(own.naming.last.p_value, best, options.false_alarm_rate) || leaves_its_form(own.naming);
  return own.goes_its_way && changes(own) && no_more;
}

bool is_preferred(const OwnValues& own, const Trial& common) {
  return changes(own) && is_preferred(own.naming.best, common, is_wear(own));
}

std::optional<Trial> in_common(const OwnValues& own, int threads) {
  Data common = own.fit;
  common.own_parameter.clear();
  return again_with(own.naming.best, common, threads);
}

Trial with_own_values(const Trial& found, const OwnValues& own, int threads) {
  const Trial none{{}, own.baseline};
  return found.effects.empty() ? none : again_with(found, own.fit, threads).value_or(none);
}

bool is_wear(const OwnValues& own) { return own.fit.own_parameter == what_wears(own.baseline->asset); }

double predicted_leakage(const FittedModel& model, const Data& fit, std::optional<UtcTime> time) {
  const Course course = course_of(model, fit);
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

std::string worn_part(const AssetConfig& asset) {
  const std::optional<ConditionSetting> scale = asset.condition ? asset.condition : plant_of(asset).condition;
  return scale && !scale->part.empty() ? scale->part : "part whose " + what_wears(asset) + " wears";
}

std::string worn_element(const AssetConfig& asset) {
  const std::optional<ConditionSetting>& of_plant = plant_of(asset).condition;
  return of_plant && of_plant->parameter == what_wears(asset) ? "piston_seal" : "";
}

std::string course_in_words(const FittedModel& model, const Data& fit) {
  return "From test to test " + fit.own_parameter + " is " + course_of(model, fit).in_words() + ".";
}

}  // namespace sealwatch::mismatch

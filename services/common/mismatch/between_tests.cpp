#include "services/common/mismatch/between_tests.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "services/common/mismatch/effects.hpp"
#include "services/common/mismatch/explain_input.hpp"
#include "services/common/mismatch/telling.hpp"

namespace sealwatch::mismatch {
namespace {

// Mean square over the noise's, of one recording by itself: the noise is known to a tenth.
constexpr double kAgrees = 1.1;

}  // namespace

double Course::standard_errors() const {
  const auto [least, most] = std::ranges::minmax(values, {}, &Value::value);
  const double largest = std::ranges::max(values, {}, &Value::std_error).std_error;
  return largest > 0.0 ? (most.value - least.value) / largest : 0.0;
}

std::string Course::in_words() const {
  constexpr std::size_t kMost = 6;
  std::vector<std::string> texts;
  for (std::size_t k = 0; k < values.size(); ++k)
    if (values.size() <= kMost || k == 0 || k + 1 == values.size())
      texts.push_back(number(values[k].value, 4) + " (" + values[k].when + ")");
    else if (k == 1)
      texts.push_back("... (" + std::to_string(values.size() - 2) + " tests)");
  return joined(texts, ", ") + (unit == "1" ? "" : " " + text::unit_text(unit));
}

double Misfit::criterion(double phi) const { return sum / phi + free * std::log(residuals); }

std::string date_or_name(const Data& data, std::size_t recording) {
  return data.start_time[recording] ? format_date(*data.start_time[recording]) : data.names[recording];
}

bool are_of_several_days(const Data& data) {
  if (data.start_time.size() < 2) return false;
  if (!std::ranges::all_of(data.start_time, [](const auto& time) { return time.has_value(); })) return false;
  return seconds_between(*data.start_time.front(), *data.start_time.back()) > kSecondsPerDay;
}

bool are_of_one_day(const Data& data) {
  const bool dated = std::ranges::all_of(data.start_time, [](const auto& time) { return time.has_value(); });
  return dated && !data.start_time.empty() && !are_of_several_days(data);
}

std::optional<ChangeBetweenTests> change_between_tests(const AssetConfig& asset, const Data& fit,
                                                       const FittedModel& best) {
  if (are_of_one_day(fit)) return std::nullopt;
  std::map<std::string, Course> courses;
  double largest_misfit = 0.0;
  Misfit alone;
  for (std::size_t k = 0; k < fit.samples.size(); ++k) {
    Data one = only(fit, k);
    one.own_parameter.clear();
    const Result<FittedModel> model = fit_model(asset, one, nullptr, 1);
    if (!model || model->misfit > kAgrees * model->residuals) return std::nullopt;
    largest_misfit = std::max(largest_misfit, model->misfit / model->residuals);
    alone.sum += model->misfit;
    alone.free += static_cast<double>(model->free_shared);
    for (const ParameterShift& parameter : parameter_shifts(asset, *model, *model)) {
      if (!std::isfinite(parameter.after_std)) continue;
      Course& course = courses[parameter.name];
      course.unit = parameter.unit;
      course.values.push_back({date_or_name(one, 0), parameter.after, parameter.after_std});
    }
  }
  const Misfit common{best.misfit, best.residuals, static_cast<double>(best.free_shared)};
  alone.residuals = common.residuals;
  const double phi = std::max(1.0, alone.sum / alone.residuals);
  if (alone.criterion(phi) >= common.criterion(phi)) return std::nullopt;
  const auto changed =
      std::ranges::max_element(courses, {}, [](const auto& entry) { return entry.second.standard_errors(); });
  if (changed == courses.end() || changed->second.standard_errors() < kChanged) return std::nullopt;
  std::string text = "Each recording alone agrees with the model (mean squared residual at most ";
  text.append(number(largest_misfit)).append(" times the noise's), all together do not: from test to test ");
  text.append(changed->first).append(" is ").append(changed->second.in_words());
  text.append(", a change of ").append(number(changed->second.standard_errors())).append(" standard errors. ");
  const PlantDescription& plant = **find_plant(asset.model);
  const bool seal = plant.condition && changed->first == plant.condition->parameter;
  text.append(seal ? "The piston seal" : "The asset");
  text.append(" changed between these tests; missing physics cannot be seen within one.");
  return ChangeBetweenTests{.sentence = std::move(text), .element = seal ? "piston_seal" : ""};
}

}  // namespace sealwatch::mismatch

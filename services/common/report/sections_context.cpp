// What had absorbed the effect, what it does to the prognosis, what could have been seen.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "sealwatch/model/plant_description.hpp"
#include "services/common/report/explanation_sections.hpp"
#include "services/common/report/page.hpp"
#include "services/common/report/plot.hpp"
#include "services/common/text/readable.hpp"

namespace sealwatch::report {
namespace {

using mismatch::Explanation;
using mismatch::ParameterShift;
using mismatch::Power;

constexpr double kClearShift = 3.0;     ///< standard errors
constexpr double kInseparable = 0.999;  ///< share from which an effect is a change of the fitted parameters

/// Shift in standard errors of the difference; NaN where neither is known.
double shift_in_errors(const ParameterShift& shift) {
  return (shift.after - shift.before) / std::hypot(shift.before_std, shift.after_std);
}

double largest_of(const ParameterShift& shift) {
  return std::max({std::abs(shift.datasheet), std::abs(shift.before), std::abs(shift.after)});
}

/// "10.68 ± 0.41", as many decimals as the error's second digit; the error is left out where the data cannot tell it.
std::string with_error(double value, double error) {
  return error > 0.0 && std::isfinite(error) ? text::readable_with_error(value, error, "")
                                             : text::number_text(value, 4);
}

/// The value with its error, or that it ended at a bound, or that the recordings do not identify it.
std::string told(double value, double error, bool at_bound) {
  std::string text = with_error(value, error);
  if (at_bound) return text.append(", at its bound");
  return std::isfinite(error) ? text : text.append(", not identifiable");
}

/// What a reader has to see first: those at a bound, then those that moved most over their error.
std::vector<const ParameterShift*> by_weight(const std::vector<ParameterShift>& shifts) {
  std::vector<const ParameterShift*> order;
  for (const ParameterShift& shift : shifts) order.push_back(&shift);
  const auto weight = [](const ParameterShift* shift) {
    if (shift->before_at_bound || shift->after_at_bound) return std::numeric_limits<double>::infinity();
    const double errors = std::abs(shift_in_errors(*shift));
    return std::isfinite(errors) ? errors : 0.0;
  };
  std::ranges::stable_sort(order, std::greater<>(), weight);
  return order;
}

std::string change_text(double from, double to) {
  if (from == 0.0 || !std::isfinite(to / from)) return "–";
  const double percent = 100.0 * (to - from) / from;
  return std::string(percent >= 0.0 ? "+" : "−").append(text::number_text(std::abs(percent), 2)).append(" %");
}

/// "55 N", or in words where no size would be seen.
std::string detectable(const Power& power) {
  if (!std::isfinite(power.minimum_detectable)) return "no size";
  return text::readable(power.minimum_detectable, power.unit, 2);
}

/// Whether an effect of a size that matters could be there unseen.
bool could_hide(const Power& power) {
  return !std::isfinite(power.minimum_detectable) ||
         (power.significant > 0.0 && power.minimum_detectable > power.significant);
}

/// What an effect would come to in these recordings.
enum class Visible { seen, as_a_parameter, not_seen };

/// An effect that the fitted parameters imitate altogether is not missing from the model: it is in their values.
Visible visible(const Power& power) {
  if (!could_hide(power)) return Visible::seen;
  return power.absorbed_share > kInseparable ? Visible::as_a_parameter : Visible::not_seen;
}

Table power_table(const std::vector<Power>& all, Visible which) {
  Table table({"law", "element", ">smallest visible", ">matters from", ">absorbed"});
  for (const Power& power : all)
    if (visible(power) == which)
      table.row({law_name(power.what), element_name(power.what.element), detectable(power),
                 power.significant > 0.0 ? text::readable(power.significant, power.unit, 2) : "–",
                 text::percent_text(power.absorbed_share)});
  return table;
}

}  // namespace

std::string parameters_section(const Explanation& explanation) {
  if (explanation.parameters.empty()) return {};
  const Result<const PlantDescription*> plant = find_plant(explanation.model);
  const bool changed = explanation.changed();
  Table table(changed ? std::vector<std::string>{"parameter", "unit", ">datasheet", ">before", ">after", ">change",
                                                 ">over its error", "~meaning"}
                      : std::vector<std::string>{"parameter", "unit", ">datasheet", ">fitted", "~meaning"});
  for (const ParameterShift* one : by_weight(explanation.parameters)) {
    const ParameterShift& shift = *one;
    const bool at_bound = shift.before_at_bound || shift.after_at_bound;
    const text::DisplayUnit unit = text::display_unit(shift.unit, largest_of(shift));
    std::vector<std::string> cells = {
        shift.name, unit.text, text::number_text(shift.datasheet * unit.factor, 4),
        told(shift.before * unit.factor, shift.before_std * unit.factor, shift.before_at_bound)};
    const double errors = std::abs(shift_in_errors(shift));
    if (changed) {
      cells.push_back(told(shift.after * unit.factor, shift.after_std * unit.factor, shift.after_at_bound));
      cells.push_back(change_text(shift.before, shift.after));
      cells.push_back(text::number_text(errors, 2));
    }
    const ParameterDescription* known = plant ? (*plant)->find_parameter(shift.name) : nullptr;
    cells.push_back(known == nullptr ? "" : known->meaning);
    for (std::string& cell : cells) cell = escaped(cell);
    table.row_of_html(cells, at_bound || (changed && errors > kClearShift) ? "strong" : "");
  }
  const char* words = changed
                          ? "A parameter that moves once the found law is added had been compensating for it. Bold: "
                            "at a bound, or moved by more than three standard errors."
                          : "The parameters as fitted to the recordings.";
  const char* bound = " A parameter at its bound is compensating for something else, or its range is wrong.";
  const bool any_at_bound = std::ranges::any_of(explanation.parameters, [](const ParameterShift& shift) {
    return shift.before_at_bound || shift.after_at_bound;
  });
  return folded_section(
      changed ? "What had absorbed the effect" : "Fitted parameters",
      changed ? "parameters before and after" : "with standard errors",
      paragraph(std::string(words).append(any_at_bound ? bound : ""), "small muted").append(table.html()));
}

std::string asset_values_section(const Explanation& explanation) {
  if (explanation.asset_values.empty()) return {};
  const Result<const PlantDescription*> plant = find_plant(explanation.model);
  Table table({"", "parameter", ">in the asset file", ">would fit", ">change", "~meaning"});
  std::size_t entry = 0;
  for (const std::vector<mismatch::AssetValue>& values : explanation.asset_values) {
    std::string which = entry++ == 0 ? "" : "or";
    for (const mismatch::AssetValue& value : values) {
      const ParameterDescription* known = plant ? (*plant)->find_parameter(value.name) : nullptr;
      table.row({which, value.name, text::readable(value.in_asset_file, value.unit, 4),
                 text::readable_with_error(value.fitted, value.std_error, value.unit),
                 change_text(value.in_asset_file, value.fitted), known == nullptr ? "" : known->meaning});
      which = "and";
    }
  }
  const bool with_effects = explanation.values_beside_effects();
  std::string beside;
  for (const mismatch::LawAt& law : explanation.beside_asset_values)
    if (!with_effects)
      beside += paragraph("Fitted together with it: " + law_of(law) +
                          ". Something is probably missing there; run explain again once the value is right.");
  return section(
      "A value in the asset file may be wrong",
      paragraph(with_effects ? "The model was fitted with this value, beside the laws above. Check the drawing "
                               "or datasheet."
                             : "The analysis treats these values as exact. With the fitted value, less "
                               "missing physics would explain the recordings, or none. Check the drawing or "
                               "datasheet first.",
                "small muted")
          .append(table.html())
          .append(beside));
}

std::string prognosis_section(const Explanation& explanation) {
  const mismatch::PrognosisShift& prognosis = explanation.prognosis;
  if (!prognosis.known || !explanation.changed()) return {};
  Table table({"", ">before", ">after", ">change"});
  table.row({prognosis.parameter, text::readable(prognosis.R_CL_before, prognosis.unit),
             text::readable(prognosis.R_CL_after, prognosis.unit),
             change_text(prognosis.R_CL_before, prognosis.R_CL_after)});
  const auto theta = [](double value) {
    return std::isfinite(value) ? text::number_text(100.0 * value, 4).append(" %") : "–";
  };
  table.row({"condition of the " + prognosis.part, theta(prognosis.theta_before), theta(prognosis.theta_after),
             change_text(prognosis.theta_before, prognosis.theta_after)});
  const auto months = [](double value) { return std::isfinite(value) ? std::to_string(std::lround(value)) : "–"; };
  if (std::isfinite(prognosis.months_after))
    table.row({"months left of a mean " + prognosis.part, months(prognosis.months_before),
               months(prognosis.months_after), change_text(prognosis.months_before, prognosis.months_after)});
  return folded_section("Effect on the remaining life", prognosis.parameter + " and condition before and after",
                        paragraph(prognosis.sentence).append(table.html()));
}

std::string power_section(const Explanation& explanation) {
  if (explanation.power.empty()) return {};
  std::map<Visible, std::size_t> count;
  for (const Power& power : explanation.power) ++count[visible(power)];
  const auto effects = [&](Visible which) { return std::to_string(count[which]); };
  std::string told = effects(Visible::seen) + " of " + std::to_string(explanation.power.size()) +
                     " effects would be seen as soon as they matter";
  std::string html = paragraph(
      "Smallest visible: the size that these recordings reveal 80 % of the time, with 1 % false alarms. Absorbed: the "
      "share of an effect that the fitted parameters would imitate.",
      "small muted");
  if (count[Visible::not_seen] > 0) {
    told += ", " + effects(Visible::not_seen) + " could stay unseen";
    html += "<h3>Could stay unseen</h3>\n" + power_table(explanation.power, Visible::not_seen).html();
  }
  if (count[Visible::as_a_parameter] > 0)
    html += folded(effects(Visible::as_a_parameter) + " that would only change the fitted values",
                   paragraph("The fitted parameters imitate these. None would leave a misfit; the values above would "
                             "be off instead.",
                             "small muted")
                       .append(power_table(explanation.power, Visible::as_a_parameter).html()));
  if (count[Visible::seen] > 0)
    html +=
        folded(effects(Visible::seen) + " that would be seen", power_table(explanation.power, Visible::seen).html());
  return folded_section("What these recordings could detect", told, html,
                        explanation.effects.empty() ? Paper::printed : Paper::closed);
}

}  // namespace sealwatch::report

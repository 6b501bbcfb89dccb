// What was found: where it sits, the laws that were added, why not others.
#include <algorithm>
#include <cctype>
#include <cmath>

#include "sealwatch/model/law_sizes.hpp"
#include "sealwatch/model/physics.hpp"
#include "sealwatch/model/plant_description.hpp"
#include "services/common/report/actuator_drawing.hpp"
#include "services/common/report/explanation_sections.hpp"
#include "services/common/report/page.hpp"
#include "services/common/text/readable.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::report {
namespace {

using mismatch::Explanation;
using mismatch::FoundEffect;

std::string elements(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text::add_to_list(text, element_name(name));
  return text;
}

std::vector<std::string> recorded_channels(const Explanation& explanation) {
  std::vector<std::string> channels;
  for (const mismatch::RecordingComparison& recording : explanation.recordings)
    for (const Series& series : recording.recorded.channels) channels.push_back(series.name);
  return channels;
}

std::string law_line(const std::string& law) {
  return std::string("<p><span class=\"law\">").append(escaped(law)).append("</span></p>\n");
}

/// What the catalogue says of a law's parameter, in the sizes of the plant `model`; "" where it does not know it.
std::string meaning_of(const mismatch::LawAt& what, const std::string& parameter, const std::string& model) {
  const Result<const PlantDescription*> plant = find_plant(model);
  for (const Law& law : all_laws())
    if (law.id == what.id && law.form == what.form)
      for (const LawParameter& known : law.parameters)
        if (known.name == parameter)
          return plant ? in_sizes_of(**plant, law, known.meaning) : std::string(known.meaning);
  return {};
}

std::string parameter_table(const FoundEffect& effect, const std::string& model) {
  Table table({"parameter", ">value ± standard error", "~meaning"});
  for (const mismatch::FoundParameter& parameter : effect.parameters) {
    table.row({parameter.name, found_value(parameter), meaning_of(effect.what, parameter.name, model)});
  }
  return table.empty() ? std::string() : table.html();
}

std::string same_laws(const FoundEffect& effect) {
  if (effect.indistinguishable.empty()) return {};
  std::string html = paragraph("These recordings cannot distinguish it from:");
  html += "<ul>\n";
  for (const mismatch::LawAt& other : effect.indistinguishable)
    html.append("<li>")
        .append(escaped(law_of(other)))
        .append(": <code>")
        .append(escaped(other.law))
        .append("</code></li>\n");
  return html.append("</ul>\n");
}

/// How large the effect is to an engineer, apart from how sure it is.
std::string size_words(double share) {
  if (std::isnan(share)) return "No size that matters is defined for this law.";
  if (!(share > 0.0)) return {};
  if (share < 1.0)
    return std::string("Its size is ")
        .append(text::number_text(share, 2))
        .append(" of the size that matters: real, but small.");
  return std::string("Its size is ")
      .append(text::number_text(share, 2))
      .append(" times the size that matters (about 1 % of what the element carries).");
}

/// "External leakage (laminar) of chamber A"
std::string title_of(const FoundEffect& effect) {
  std::string title = law_of(effect.what);
  if (!title.empty()) title[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(title[0])));
  return title;
}

/// The law, its figures and what it may be taken for, in a few lines.
std::string effect_in_short(const FoundEffect& effect) {
  std::string html = std::string("<h3>").append(escaped(title_of(effect))).append("</h3>\n");
  html += law_line(effect.what.law);
  for (const mismatch::FoundParameter& parameter : effect.parameters)
    html += paragraph(parameter.name + " = " + found_value(parameter));
  html += paragraph("Probability of this law: " + text::percent_text(effect.probability) +
                        "; of this element: " + text::percent_text(effect.element_probability) + " (not calibrated).",
                    "small muted");
  std::string others;
  for (const mismatch::LawAt& other : effect.indistinguishable) text::add_to_list(others, law_of(other), "; ");
  if (!others.empty()) html += paragraph("Cannot be distinguished from: " + others + ".", "small muted");
  return html;
}

std::string effect_html(const FoundEffect& effect, const std::string& model) {
  std::string html = std::string("<h3>").append(escaped(title_of(effect))).append("</h3>\n");
  if (!effect.what.meaning.empty()) html += paragraph(effect.what.meaning);
  html += law_line(effect.what.law);
  html += parameter_table(effect, model);
  std::string sure =
      std::string("Probability ").append(text::percent_text(effect.probability)).append(" among the laws tried; ");
  sure.append(text::percent_text(effect.element_probability))
      .append(
          " that it sits in this element (not calibrated). Without it, the criterion (misfit plus a penalty for each "
          "parameter) is ")
      .append(text::number_text(-effect.delta_bic, 3))
      .append(" higher; 12 is decisive. ")
      .append(size_words(effect.engineering_share));
  html += paragraph(sure);
  if (!effect.regime.empty()) html += paragraph(std::string("It acts: ").append(effect.regime).append("."));
  if (!effect.evidence.empty()) html += paragraph(effect.evidence);
  html += same_laws(effect);
  if (!effect.same_elements.empty())
    html += paragraph(std::string("These recordings fit equally well with it in: ")
                          .append(elements(effect.same_elements))
                          .append("."));
  return html;
}

void add_alternative(const mismatch::Alternative& alternative, Table& table) {
  const std::string name = escaped(law_name(alternative.what));
  table.row_of_html({std::string(name)
                         .append("<br/><code class=\"small muted\">")
                         .append(escaped(alternative.what.law))
                         .append("</code>"),
                     escaped(element_name(alternative.what.element)),
                     escaped(text::number_text(alternative.misfit_above_best)), escaped(alternative.why_not)});
}

/// The nearest ones open, the rest folded.
std::string alternatives_to(const FoundEffect& effect) {
  constexpr std::size_t kOpen = 5;
  const std::vector<std::string> columns = {"~instead of " + law_name(effect.what), "element",
                                            ">criterion above the best", "~why not"};
  Table near(columns);
  Table far(columns);
  for (std::size_t k = 0; k < effect.alternatives.size(); ++k)
    add_alternative(effect.alternatives[k], k < kOpen ? near : far);
  std::string html = near.empty() ? std::string() : near.html();
  if (!far.empty())
    html += folded(std::to_string(effect.alternatives.size() - kOpen) + " more that fit worse", far.html());
  return html;
}

/// In the order of what they would have taken.
std::string rejected_html(const std::vector<mismatch::Rejected>& list) {
  std::string words =
      "Each law was first tried alone on the original model. These would fit only with a physically impossible value "
      "and are not claimed. Most of them mimic what is really missing.";
  if (list.front().allowed_share > 0.0)
    words.append(" The best law with a possible value would have explained ")
        .append(text::percent_text(list.front().allowed_share))
        .append(" of the misfit beyond noise.");
  Table table({"law", "element", ">share of the misfit explained", "~why it is rejected"});
  for (const mismatch::Rejected& rejected : list)
    table.row_of_html({std::string(escaped(law_name(rejected.what)))
                           .append("<br/><code class=\"small muted\">")
                           .append(escaped(rejected.what.law))
                           .append("</code>"),
                       escaped(element_name(rejected.what.element)),
                       escaped(rejected.share > 0.0 ? text::percent_text(rejected.share) : "–"),
                       escaped(rejected.why)});
  return std::string("<h3>Better fits that physics forbids</h3>\n")
      .append(paragraph(words, "small muted"))
      .append(table.html());
}

/// A sensor or the recorded input is no part of the model.
const char* heading_of(const Explanation& explanation) {
  if (explanation.effects.empty())
    return explanation.asset_values.empty() ? "What stands out" : "The value in question";
  const bool recorded = std::ranges::all_of(explanation.effects, [](const FoundEffect& effect) {
    return effect.what.element.starts_with("sensor:") || effect.what.element.starts_with("input:") ||
           effect.what.element == "clock";
  });
  return recorded ? "What explains the difference" : "What the model lacks";
}

}  // namespace

std::string first_screen(const Explanation& explanation) {
  const Result<const PlantDescription*> plant = find_plant(explanation.model);
  if (!plant) return {};
  std::string found;
  for (const FoundEffect& effect : explanation.effects) found += effect_in_short(effect);
  if (found.empty() && !explanation.asset_values.empty()) {
    for (const mismatch::AssetValue& value : explanation.asset_values.front())
      found += paragraph(value.name + " = " + text::readable_with_error(value.fitted, value.std_error, value.unit) +
                         " fits; the asset file has " + text::readable(value.in_asset_file, value.unit, 4) + ".");
    if (explanation.asset_values.size() > 1)
      found += paragraph("Other values would explain as much: see the table below.", "small muted");
  }
  if (found.empty()) {
    for (const mismatch::Location& place : explanation.location) {
      const bool said = explanation.summary.find(place.evidence) != std::string::npos;
      found += paragraph(element_name(place.element) + ", " + text::percent_text(place.probability) +
                         (said ? "." : ": " + place.evidence));
    }
    found += paragraph(explanation.location.empty() ? "No element stands out." : "No law is claimed for it.", "muted");
  }
  return std::string("<div class=\"screen\">\n<div>\n<h2>")
      .append(heading_of(explanation))
      .append("</h2>\n")
      .append(found)
      .append("</div>\n<div>\n")
      .append(actuator_drawing(**plant, explanation.location, recorded_channels(explanation)))
      .append("</div>\n</div>\n");
}

std::string where_section(const Explanation& explanation) {
  if (explanation.location.empty()) return {};
  Table table({"element", ">probability", "indistinguishable from", "~evidence"});
  for (const mismatch::Location& place : explanation.location) {
    const std::string element = element_name(place.element);
    table.row({element, text::percent_text(place.probability), elements(place.indistinguishable_from), place.evidence});
  }
  return folded_section("Location", "probability (not calibrated) and evidence for each element", table.html());
}

std::string effects_section(const Explanation& explanation) {
  if (explanation.effects.empty()) return {};
  std::string html;
  for (const FoundEffect& effect : explanation.effects) html += effect_html(effect, explanation.model);
  return folded_section("The laws in full", "parameters, size, where each acts", html);
}

std::string candidates_section(const Explanation& explanation) {
  if (explanation.candidates.empty()) return {};
  Table table({"law", "element", ">share of the excess misfit", ">probability"});
  for (const mismatch::CandidateCause& cause : explanation.candidates)
    table.row({law_name(cause.what), element_name(cause.what.element), text::percent_text(cause.share),
               text::percent_text(cause.probability)});
  return folded_section(
      "Other candidates", "seen beside the claimed effects, not claimed",
      paragraph("Share of the remaining misfit that each would explain alone, to first order.", "small muted")
          .append(table.html()));
}

std::string alternatives_section(const Explanation& explanation) {
  std::string html;
  for (const FoundEffect& effect : explanation.effects) html += alternatives_to(effect);
  if (!explanation.rejected.empty()) {
    html += rejected_html(explanation.rejected);
  }
  return html.empty() ? std::string() : folded_section("Alternatives, and why not", "laws that fit worse", html);
}

}  // namespace sealwatch::report

#include "services/common/report/explanation_html.hpp"

#include <cctype>
#include <cmath>
#include <string_view>

#include "services/common/report/explanation_sections.hpp"
#include "services/common/report/page.hpp"
#include "services/common/text/estimates.hpp"
#include "services/common/text/law_words.hpp"
#include "services/common/text/readable.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::report {
namespace {

using mismatch::Explanation;
using mismatch::Verdict;

struct VerdictWords {
  std::string_view css_class;
  std::string words;
};

VerdictWords words_of(const Explanation& explanation) {
  switch (explanation.verdict) {
    case Verdict::consistent:
      return {"good", "Consistent: no mismatch was found"};
    case Verdict::mismatch:
      return {"bad", std::string("Mismatch found and ")
                         .append(explanation.holdout.missed() == nullptr ? "explained" : "partly explained")
                         .append(explanation.asset_values.empty() ? ""
                                 : explanation.values_beside_effects()
                                     ? ": missing physics and a wrong value in the asset file"
                                     : ": missing physics, or a wrong value in the asset file")};
    case Verdict::undetermined:
      if (!explanation.asset_values.empty()) return {"warn", "Undetermined: a value of the asset file may be wrong"};
      return {"warn", explanation.statistically_significant ? "Undetermined: a mismatch without an explanation"
                                                            : "Undetermined: these recordings cannot decide"};
  }
  return {"warn", "Undetermined"};
}

void add_figure(const std::string& value, const std::string& meaning, std::string& html) {
  html.append("<div><b>")
      .append(escaped(value))
      .append("</b><span>")
      .append(escaped(meaning))
      .append("</span></div>\n");
}

/// What to look at for one effect, and how soon.
std::string step_for(const mismatch::FoundEffect& effect, const std::string& worn_part) {
  const std::string& element = effect.what.element;
  const bool sensor = element.starts_with("sensor:") || element.starts_with("input:") || element == "clock";
  std::string step = (sensor ? "Check " : "Inspect ") + the_element(element) +
                     (sensor ? " against a reference for " : " for ") + law_name(effect.what);
  if (!effect.what.meaning.empty()) step += ": " + effect.what.meaning;
  step += ". ";
  if (effect.engineering_share >= 1.0)
    step += "It is " + text::number_text(effect.engineering_share, 2) + " times the size that matters: do this " +
            (worn_part.empty() ? "soon" : "before you rely on the condition of the " + worn_part) +
            ". If the effect is normal for this asset, keep it in the asset file.";
  else if (effect.engineering_share > 0.0)
    step += "It is " + text::number_text(effect.engineering_share, 2) +
            " of the size that matters: it can wait for the next planned work. Follow it in the next tests.";
  else
    step += "It is either normal for this asset or a fault.";
  std::vector<std::string> others;
  for (const std::string& other : effect.same_elements) others.push_back(the_element(other));
  if (!others.empty()) step += " These recordings fit equally well with it at " + text::joined(others, " or ") + ".";
  return step;
}

// What was found is not all: another law, perhaps none of the catalogue, takes part in what it takes.
std::string step_for_the_rest(const Explanation& explanation, const mismatch::ChannelComparison& missed) {
  std::string step = "Find the rest before you use asset.explained.yaml: " + text::in_words(missed.channel) +
                     " still misses by " + text::misfit_text(missed.rms_after) +
                     " times its noise, and the cause may be another one.";
  if (!explanation.rejected.empty() &&
      explanation.rejected.front().share > explanation.rejected.front().allowed_share) {
    const mismatch::Rejected& better = explanation.rejected.front();
    step += " Look at " + the_element(better.what.element) + " first: " + law_name(better.what) +
            " would take more there, with a value that physics forbids.";
  }
  return step + " A law that the catalogue does not have can be written in the plant's file, under laws.";
}

// Once the physics is known: look there, calculate with it, settle what is open.
std::vector<std::string> steps_after(const Explanation& explanation) {
  std::vector<std::string> steps;
  const std::optional<ConditionSetting>& wear = explanation.explained.condition;
  const std::string worn_part = wear ? wear->part : "";
  for (const mismatch::FoundEffect& effect : explanation.effects) steps.push_back(step_for(effect, worn_part));
  if (const mismatch::ChannelComparison* missed = explanation.holdout.missed())
    steps.push_back(step_for_the_rest(explanation, *missed));
  else
    steps.emplace_back(
        "Use asset.explained.yaml instead of the asset file in fit, forecast, simulate and explain. For the services, "
        "put it in place of the asset file.");
  if (!explanation.next_test.empty()) steps.push_back(explanation.next_test);
  return steps;
}

std::string arrow(double before, double after) {
  return text::misfit_text(before).append(" → ").append(text::misfit_text(after));
}

std::string figures(const Explanation& explanation) {
  std::string html = "<div class=\"figures\">\n";
  add_figure(text::p_value_text(explanation.p_value), "chance that noise alone explains it", html);
  const bool changed = explanation.changed();
  const auto add_misfit = [&html, changed](const mismatch::PooledFit& fit, const std::string& where) {
    const Misfit misfit = overall(fit);
    if (misfit.known)
      add_figure(changed ? arrow(misfit.before, misfit.after) : text::misfit_text(misfit.before),
                 std::string("misfit, ").append(where), html);
  };
  add_misfit(explanation.holdout, explanation.holdout_recordings.empty() ? "left out in turn" : "held out");
  add_misfit(explanation.fit, "fitted");
  // Where the misfit was at its floor already, 0 % would seem to deny what was found.
  if (changed && explanation.explained_share >= 0.005)
    add_figure(text::percent_text(explanation.explained_share), "of the misfit explained", html);
  return html.append("</div>\n")
      .append(
          paragraph("Misfit: rms of (recording − simulation) / sensor noise; at 1 only noise remains.", "small muted"));
}

}  // namespace

Misfit overall(const mismatch::PooledFit& fit) {
  Misfit misfit;
  double count = 0.0;
  for (const mismatch::ChannelComparison& channel : fit.channels) {
    if (!std::isfinite(channel.rms_before)) continue;
    misfit.before += channel.rms_before * channel.rms_before;
    misfit.after += channel.rms_after * channel.rms_after;
    ++count;
  }
  misfit.known = count > 0.0;
  if (!misfit.known) return misfit;
  misfit.before = std::sqrt(misfit.before / count);
  misfit.after = std::sqrt(misfit.after / count);
  return misfit;
}

std::string law_name(const mismatch::LawAt& what) {
  std::string name = text::in_words(what.id);
  if (!what.form.empty()) name.append(" (").append(text::in_words(what.form)).append(")");
  return name;
}

std::string found_value(const mismatch::FoundParameter& parameter) {
  std::string text = text::readable_with_error(parameter.value, parameter.std_error, parameter.unit);
  if (parameter.at_bound) return text.append(", at its bound");
  return std::isfinite(parameter.std_error) ? text : text.append(", not identifiable");
}

std::string element_name(const std::string& element) {
  constexpr std::string_view kSensor = "sensor:";
  constexpr std::string_view kInput = "input:";
  if (element.starts_with(kInput)) return "recorded input " + text::in_words(element.substr(kInput.size()));
  return element.starts_with(kSensor) ? "sensor of " + text::in_words(element.substr(kSensor.size()))
                                      : text::in_words(element);
}

std::string law_of(const mismatch::LawAt& what) {
  return text::law_at(law_name(what), what.element, the_element(what.element), "of");
}

std::string the_element(const std::string& element) {
  const std::string name = element_name(element);
  const std::size_t last = name.find_last_of(' ');
  const bool numbered = last != std::string::npos &&
                        (last + 2 == name.size() || std::isdigit(static_cast<unsigned char>(name[last + 1])) != 0);
  return numbered && !element.starts_with("sensor:") && !element.starts_with("input:") ? name : "the " + name;
}

std::string banner(const Explanation& explanation) {
  const VerdictWords verdict = words_of(explanation);
  std::string aside = std::to_string(explanation.holdout_recordings.size()) + " held out.";
  if (explanation.holdout_recordings.empty())
    aside = explanation.fit_recordings.size() > 1 ? "each left out in turn." : "none held out.";
  std::string html = paragraph("Asset " + explanation.asset_id + ", model " + explanation.model + ". " +
                                   std::to_string(explanation.fit_recordings.size()) + " recordings fitted, " + aside,
                               "muted small");
  html.append("<div class=\"banner ").append(verdict.css_class).append("\">\n");
  html.append(paragraph(verdict.words, "verdict")).append(paragraph(explanation.summary));
  return html.append("</div>\n").append(figures(explanation));
}

std::vector<std::string> steps_of(const Explanation& explanation) {
  if (explanation.verdict == Verdict::mismatch) return steps_after(explanation);
  if (explanation.verdict == Verdict::consistent)
    return {"No repair is needed. " + (explanation.next_test.empty()
                                           ? "Compare each new test with this model: sealwatch validate --asset "
                                             "asset.explained.yaml --out DIR TEST.csv"
                                           : explanation.next_test)};
  if (explanation.next_test.empty()) return {};
  return {explanation.next_test};
}

std::string next_steps(const Explanation& explanation) {
  const std::vector<std::string> all = steps_of(explanation);
  if (all.empty()) return {};
  std::string html;
  for (const std::string& step : all) html.append("<li>").append(escaped(step)).append("</li>\n");
  if (explanation.verdict == Verdict::mismatch)
    html = "<ol>\n" + html + "</ol>\n";
  else
    html = paragraph(all.front());
  if (explanation.verdict == Verdict::consistent)
    html += paragraph("See below what these recordings could not have shown.", "small muted");
  const bool record =
      explanation.verdict == Verdict::undetermined && explanation.asset_values.empty() && explanation.not_asked.empty();
  return std::string("<div class=\"steps\">\n<h2>")
      .append(record ? "What to record next" : "What to do next")
      .append("</h2>\n")
      .append(html)
      .append("</div>\n");
}

std::string notes_section(const Explanation& explanation) {
  std::string html = "<ul>\n<li>";
  html.append(escaped("Fitted: " + text::joined(explanation.fit_recordings) + ".")).append("</li>\n");
  if (!explanation.holdout_recordings.empty())
    html.append("<li>")
        .append(escaped("Held out: " + text::joined(explanation.holdout_recordings) + "."))
        .append("</li>\n");
  for (const std::string& note : explanation.notes) html.append("<li>").append(escaped(note)).append("</li>\n");
  html +=
      "<li>Misfit / noise: root mean square of (recording - simulation) / sensor noise; 1 is the floor. Fit: 100 % is "
      "perfect, 0 % is no better than a constant.</li>\n"
      "<li>p, white: probability that pure noise gives residuals as smooth as these. p, independent of input: "
      "probability that pure noise correlates as much with the input. Below 0.01, the residual contains dynamics that "
      "the model does not explain.</li>\n"
      "<li>A held-out recording takes no part in any fit or choice. Only its own initial state and load are "
      "estimated.</li>\n</ul>\n";
  return folded_section("Notes", "recordings, definitions, what was tried", html);
}

std::string explanation_to_html(const Explanation& explanation) {
  std::string body = "<h1>Simulation and recordings of ";
  body.append(escaped(explanation.asset_id)).append("</h1>\n");
  const bool nothing_found = explanation.effects.empty();
  body.append(banner(explanation)).append(first_screen(explanation));
  body += next_steps(explanation);
  if (nothing_found) body += asset_values_section(explanation);
  if (nothing_found) body += power_section(explanation);  // what the silence is worth
  body.append(effects_section(explanation))
      .append(nothing_found ? std::string() : asset_values_section(explanation))
      .append(missing_section(explanation))
      .append(overlays_section(explanation))
      .append(comparison_section(explanation))
      .append(parameters_section(explanation))
      .append(prognosis_section(explanation))
      .append(where_section(explanation))
      .append(candidates_section(explanation))
      .append(alternatives_section(explanation));
  if (!nothing_found) body += power_section(explanation);
  return html_page("Mismatch report, " + explanation.asset_id, body.append(notes_section(explanation)));
}

}  // namespace sealwatch::report

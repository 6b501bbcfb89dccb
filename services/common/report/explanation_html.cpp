#include "services/common/report/explanation_html.hpp"

#include <cmath>
#include <string_view>

#include "services/common/report/explanation_sections.hpp"
#include "services/common/report/page.hpp"
#include "services/common/report/readable.hpp"

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
      return {"good", "Consistent: simulation and recordings agree within the noise"};
    case Verdict::mismatch:
      return {"bad", explanation.asset_values.empty()
                         ? "Mismatch found and explained"
                         : "Mismatch found and explained, by physics or by a value of the asset file"};
    case Verdict::undetermined:
      if (!explanation.asset_values.empty()) return {"warn", "Undetermined: a value of the asset file may be wrong"};
      return {"warn", explanation.statistically_significant ? "Undetermined: a mismatch that is not explained"
                                                            : "Undetermined: these recordings cannot tell"};
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

std::string list_of(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text.append(text.empty() ? "" : ", ").append(name);
  return text;
}

// Once the physics is known: look there, calculate with it, settle what is open.
std::string steps_after(const Explanation& explanation) {
  std::string html = "<ol>\n";
  const auto add = [&html](const std::string& step) { html.append("<li>").append(escaped(step)).append("</li>\n"); };
  for (const mismatch::FoundEffect& effect : explanation.effects) {
    std::string step = "Inspect the " + element_name(effect.what.element) + " for " + law_name(effect.what) +
                       ": it belongs there, or it is a fault.";
    std::vector<std::string> others;
    for (const std::string& other : effect.same_elements) others.push_back(element_name(other));
    if (!others.empty()) step += " It may as well sit in: " + list_of(others) + ".";
    add(step);
  }
  add("Calculate with it: asset.explained.yaml of this analysis, in place of the asset's file, for fit, forecast, "
      "simulate and the next explain; in the services, accept this discrepancy (sealwatch accept), which can be "
      "revoked.");
  add(explanation.next_test.empty() ? "Nothing more has to be recorded to settle this." : explanation.next_test);
  return html.append("</ol>\n");
}

std::string arrow(double before, double after) {
  return number_text(before, 3).append(" → ").append(number_text(after, 3));
}

std::string figures(const Explanation& explanation) {
  std::string html = "<div class=\"figures\">\n";
  add_figure(p_value_text(explanation.p_value), "probability of noise alone", html);
  const bool changed = explanation.changed();
  const auto add_misfit = [&html, changed](const mismatch::PooledFit& fit, const std::string& where) {
    const Misfit misfit = overall(fit);
    if (misfit.known)
      add_figure(changed ? arrow(misfit.before, misfit.after) : number_text(misfit.before, 3),
                 std::string("misfit over noise, ").append(where), html);
  };
  add_misfit(explanation.holdout, "kept aside");
  add_misfit(explanation.fit, "fitted");
  if (changed) add_figure(percent_text(explanation.explained_share), "of the misfit explained", html);
  return html.append("</div>\n");
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
  std::string name = words_of(what.id);
  if (!what.form.empty()) name.append(" (").append(words_of(what.form)).append(")");
  return name;
}

std::string element_name(const std::string& element) {
  constexpr std::string_view kSensor = "sensor:";
  return element.starts_with(kSensor) ? "sensor of " + words_of(element.substr(kSensor.size())) : words_of(element);
}

std::string banner(const Explanation& explanation) {
  const VerdictWords verdict = words_of(explanation);
  std::string html = "<p class=\"muted small\">";
  html.append(escaped("Asset " + explanation.asset_id + ", model " + explanation.model +
                      ". Fitted: " + list_of(explanation.fit_recordings) + ". "));
  std::string aside = "Kept aside: " + list_of(explanation.holdout_recordings) + ".";
  if (explanation.holdout_recordings.empty())
    aside = explanation.fit_recordings.size() > 1 ? "No recording was kept aside: each was left out in turn."
                                                  : "No recording was kept aside.";
  html.append(escaped(aside));
  html.append("</p>\n<div class=\"banner ").append(verdict.css_class).append("\">\n");
  html.append(paragraph(verdict.words, "verdict")).append(paragraph(explanation.summary));
  if (!explanation.next_test.empty()) html.append(paragraph("Next: " + explanation.next_test, "small"));
  return html.append("</div>\n").append(figures(explanation));
}

std::string next_section(const Explanation& explanation) {
  if (explanation.verdict == Verdict::mismatch) return section("What to do next", steps_after(explanation));
  if (explanation.next_test.empty()) return {};
  return section(explanation.asset_values.empty() ? "What to record next" : "What to do next",
                 paragraph(explanation.next_test));
}

std::string notes_section(const Explanation& explanation) {
  std::string html = "<ul>\n";
  for (const std::string& note : explanation.notes) html.append("<li>").append(escaped(note)).append("</li>\n");
  html +=
      "<li>Misfit over noise: root mean square of (recording - simulation) / noise of the sensor; 1 is the floor. "
      "Fit: 100 % is perfect, 0 % no better than a constant.</li>\n"
      "<li>p, white: how likely noise alone leaves residuals as smooth as these; p, independent of input: as much like "
      "the input. Below 0.01 a residual has a course of its own that the model does not explain.</li>\n"
      "<li>A recording that was kept aside took no part in any fit or choice, but for its own starting state and "
      "load.</li>\n</ul>\n";
  return section("Notes", html);
}

std::string explanation_to_html(const Explanation& explanation) {
  std::string body = "<h1>Simulation and recordings of ";
  body.append(escaped(explanation.asset_id)).append("</h1>\n");
  const bool nothing_found = explanation.effects.empty();
  body += banner(explanation);
  if (nothing_found) body += asset_values_section(explanation);
  if (nothing_found) body += power_section(explanation);  // what the silence is worth
  body.append(where_section(explanation))
      .append(effects_section(explanation))
      .append(nothing_found ? std::string() : asset_values_section(explanation))
      .append(missing_section(explanation))
      .append(overlays_section(explanation))
      .append(comparison_section(explanation))
      .append(parameters_section(explanation))
      .append(prognosis_section(explanation))
      .append(alternatives_section(explanation));
  if (!nothing_found) body += power_section(explanation);
  body.append(next_section(explanation)).append(notes_section(explanation));
  return html_page("Mismatch report, " + explanation.asset_id, body);
}

}  // namespace sealwatch::report

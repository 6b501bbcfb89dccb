// The missing force, flow, torque or voltage: over time, and against the state that it depends on.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <span>
#include <string_view>
#include <vector>

#include "services/common/report/explanation_sections.hpp"
#include "services/common/report/page.hpp"
#include "services/common/report/plot.hpp"
#include "services/common/text/law_words.hpp"
#include "services/common/text/readable.hpp"

namespace sealwatch::report {
namespace {

using mismatch::MissingTerm;

constexpr std::size_t kShownOpen = 2;     ///< terms that are shown open, the others folded
constexpr std::size_t kMostPoints = 240;  ///< over what the term depends on
constexpr int kHeight = 240;              ///< of a plot, pixels
constexpr double kGap = 3.0;              ///< steps of time, from which on it is interrupted
constexpr double kLawWidth = 1.8;         ///< of its line, pixels
constexpr std::string_view kDemanded = "required by data, 95 %";
constexpr double kActs = 0.1;           ///< of its largest size, from which a law acts
constexpr double kMostlyOutside = 0.5;  ///< share of the points within the interval below which it is said

/// "Coulomb friction of the piston: missing force against +x", "External leakage of chamber A: missing flow"; the axes say in which unit.
std::string title_of(const MissingTerm& term) {
  std::string title = element_name(term.element);
  if (!term.what.id.empty()) title = text::law_at(law_name(term.what), term.element, the_element(term.element), "of");
  title[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(title[0])));
  return title.append(": missing ").append(term.quantity);
}

bool has_law(const MissingTerm& term) { return term.law.size() == term.time_s.size() && !term.law.empty(); }

std::string title_of_plots(const MissingTerm& term) { return std::string("missing ").append(term.quantity); }

/// Stretches of time without a gap: windows that were not analysed lie between them.
std::vector<std::span<const double>> stretches_of(std::span<const double> time) {
  std::vector<std::span<const double>> stretches;
  std::size_t begin = 0;
  for (std::size_t k = 1; k <= time.size(); ++k) {
    if (k < time.size() && (k < begin + 2 || time[k] - time[k - 1] <= kGap * (time[k - 1] - time[k - 2]))) continue;
    stretches.push_back(time.subspan(begin, k - begin));
    begin = k;
  }
  return stretches;
}

/// The same part of values at these times.
std::vector<double> part_of(const std::vector<double>& values, std::size_t begin, std::size_t size) {
  const auto first = values.begin() + static_cast<std::ptrdiff_t>(begin);
  return {first, first + static_cast<std::ptrdiff_t>(size)};
}

Plot over_time(const MissingTerm& term) {
  Plot plot{
      .title = title_of_plots(term), .x = {.label = "time", .unit = "s"}, .y = {.unit = term.unit}, .height = kHeight};
  plot.marks.emplace_back(Reference{.at = 0.0});
  if (std::min(term.demanded.size(), term.band.size()) < term.time_s.size()) return plot;
  for (const std::span<const double> time : stretches_of(term.time_s)) {
    const auto begin = static_cast<std::size_t>(time.data() - term.time_s.data());
    const std::vector<double> x(time.begin(), time.end()), demanded = part_of(term.demanded, begin, time.size());
    Band band{.x = x, .ink = Ink::muted, .label = std::string(begin == 0 ? kDemanded : "")};
    for (std::size_t k = 0; k < time.size(); ++k) {
      band.low.push_back(demanded[k] - term.band[begin + k]);
      band.high.push_back(demanded[k] + term.band[begin + k]);
    }
    plot.marks.emplace_back(std::move(band));
    plot.marks.emplace_back(Line{.x = x, .y = demanded, .ink = Ink::muted});
    if (has_law(term))
      plot.marks.emplace_back(Line{.x = x,
                                   .y = part_of(term.law, begin, time.size()),
                                   .ink = Ink::first,
                                   .label = begin == 0 ? "law, averaged alike" : "",
                                   .width = kLawWidth});
  }
  return plot;
}

/// What the data demand over what the term depends on, and the law itself.
Plot over_state(const MissingTerm& term) {
  Plot plot{.title = title_of_plots(term),
            .x = {.label = term.state, .unit = term.state_unit},
            .y = {.unit = term.unit},
            .height = kHeight};
  Intervals points{.ink = Ink::muted, .label = std::string(kDemanded)};
  const std::size_t size = std::min({term.state_value.size(), term.demanded.size(), term.band.size()});
  const std::size_t step = size / kMostPoints + 1;
  for (std::size_t k = 0; k < size; k += step) {
    points.x.push_back(term.state_value[k]);
    points.y.push_back(term.demanded[k]);
    points.low.push_back(term.demanded[k] - term.band[k]);
    points.high.push_back(term.demanded[k] + term.band[k]);
  }
  plot.marks.emplace_back(Reference{.at = 0.0});
  plot.marks.emplace_back(std::move(points));
  if (!term.path_law.empty())
    plot.marks.emplace_back(
        Line{.x = term.path_state, .y = term.path_law, .ink = Ink::first, .label = "law", .width = kLawWidth});
  return plot;
}

/// Share of the points at which the law acts and runs within the interval.
double share_inside(const MissingTerm& term) {
  double largest = 0.0;
  for (const double value : term.law) largest = std::max(largest, std::abs(value));
  std::size_t inside = 0, known = 0;
  for (std::size_t k = 0; k < std::min({term.law.size(), term.demanded.size(), term.band.size()}); ++k) {
    if (!std::isfinite(term.law[k] + term.demanded[k] + term.band[k]) || std::abs(term.law[k]) < kActs * largest)
      continue;
    ++known;
    if (std::abs(term.law[k] - term.demanded[k]) <= term.band[k]) ++inside;
  }
  return known == 0 ? 1.0 : static_cast<double>(inside) / static_cast<double>(known);
}

std::string agreement_of(const MissingTerm& term) {
  if (!has_law(term)) return {};
  const double inside = share_inside(term);
  std::string words =
      "Where the law acts, it lies within the interval at " + text::percent_text(inside) + " of the points.";
  if (inside < kMostlyOutside)
    words +=
        " Elsewhere a further effect is missing, or the law itself responds to the missing term (overflow, end stop, "
        "dry friction), which makes the interval too narrow.";
  return paragraph(words, "small muted");
}

std::string plots_of(const MissingTerm& term) {
  std::string html = "<div class=\"plots\">\n<div>";
  html.append(to_svg(over_time(term))).append("</div>\n");
  if (!term.state_value.empty()) html.append("<div>").append(to_svg(over_state(term))).append("</div>\n");
  return html.append("</div>\n").append(agreement_of(term));
}

}  // namespace

std::string missing_section(const mismatch::Explanation& explanation) {
  if (explanation.missing.empty()) return {};
  std::string html = paragraph(
      "What the data require is estimated without any law, from the balance of the element, as means over short "
      "times; beside a jump a mean lies between both sides. Shown is the recording in which the law can be read best. "
      "Where the law runs within the 95 % interval, law and data agree.",
      "small muted");
  for (std::size_t k = 0; k < explanation.missing.size(); ++k) {
    const MissingTerm& term = explanation.missing[k];
    const std::string label = title_of(term).append(", recording ").append(term.recording);
    if (k < kShownOpen)
      html.append("<h3>").append(escaped(label)).append("</h3>\n").append(plots_of(term));
    else
      html += folded(label, plots_of(term));
  }
  return folded_section("The missing term", "what the data require without any law, and the law", html, Paper::printed);
}

}  // namespace sealwatch::report

// The missing force, flow, torque or voltage: over time, and against the state that it depends on.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

#include "services/common/report/explanation_sections.hpp"
#include "services/common/report/page.hpp"
#include "services/common/report/plot.hpp"
#include "services/common/text/readable.hpp"

namespace sealwatch::report {
namespace {

using mismatch::MissingTerm;

constexpr std::size_t kShownOpen = 2;    ///< terms that are shown open, the others folded
constexpr std::size_t kMostDots = 900;   ///< of a scatter
constexpr std::size_t kBins = 60;        ///< of the state's range, for the law
constexpr std::size_t kBandGroups = 15;  ///< of what the data demand over the state,
constexpr std::size_t kLeastPoints = 6;  ///< of at least so many points
constexpr double kBand = 1.96;           ///< standard deviations: 95 %
constexpr double kRounding = 1e-9;       ///< of a constant law's means
constexpr double kActs = 0.1;            ///< of its largest size, from which a law acts
constexpr double kMostlyOutside = 0.5;   ///< share of the points inside the band below which it is said
constexpr double kOneValued = 0.1;       ///< of the law's range: the two ways through a state differ by less

/// "Coulomb friction of the piston: missing force against +x", "External leakage of chamber A: missing flow"; the axes say in which unit.
std::string title_of(const MissingTerm& term) {
  std::string title = element_name(term.element);
  if (!term.what.id.empty()) title = law_name(term.what).append(" of ").append(the_element(term.element));
  title[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(title[0])));
  return title.append(": missing ").append(term.quantity);
}

bool has_law(const MissingTerm& term) { return term.law.size() == term.time_s.size() && !term.law.empty(); }

Plot over_time(const MissingTerm& term) {
  Plot plot{.title = std::string("missing ").append(term.quantity),
            .x = {.label = "time", .unit = "s"},
            .y = {.unit = term.unit},
            .height = 240};
  Band band{.x = term.time_s, .ink = Ink::muted, .label = "band"};
  const std::size_t size = std::min(term.demanded.size(), term.band.size());
  for (std::size_t k = 0; k < size; ++k) {
    band.low.push_back(term.demanded[k] - term.band[k]);
    band.high.push_back(term.demanded[k] + term.band[k]);
  }
  plot.marks.emplace_back(Reference{.at = 0.0});
  if (size > 0) plot.marks.emplace_back(std::move(band));
  plot.marks.emplace_back(Line{.x = term.time_s, .y = term.demanded, .ink = Ink::muted, .label = "required by data"});
  if (has_law(term))
    plot.marks.emplace_back(Line{.x = term.time_s, .y = term.law, .ink = Ink::first, .label = "law", .width = 1.8});
  return plot;
}

/// Means over bins of the state, of the samples of one way through it.
struct Branch {
  std::vector<double> sum = std::vector<double>(kBins, 0.0);
  std::vector<double> count = std::vector<double>(kBins, 0.0);
  [[nodiscard]] double mean(std::size_t bin) const {
    return count[bin] > 0.0 ? sum[bin] / count[bin] : std::numeric_limits<double>::quiet_NaN();
  }
};

struct Bins {
  double low = 0.0, step = 1.0;
  [[nodiscard]] std::size_t of(double state) const {
    return static_cast<std::size_t>(std::clamp((state - low) / step, 0.0, static_cast<double>(kBins) - 1.0));
  }
  [[nodiscard]] double middle(std::size_t bin) const { return low + step * (static_cast<double>(bin) + 0.5); }
};

/// The law over the bins, separately where the state rises and falls.
void add_law(const MissingTerm& term, const Bins& bins, Plot& plot) {
  Branch rising;
  Branch falling;
  const std::vector<double>& state = term.state_value;
  for (std::size_t k = 0; k < state.size(); ++k) {
    if (!std::isfinite(state[k]) || !std::isfinite(term.law[k])) continue;
    const double ahead = state[std::min(k + 1, state.size() - 1)] - state[k == 0 ? 0 : k - 1];
    Branch& branch = ahead >= 0.0 ? rising : falling;
    branch.sum[bins.of(state[k])] += term.law[k];
    ++branch.count[bins.of(state[k])];
  }
  const auto [least, most] = std::minmax_element(term.law.begin(), term.law.end());
  double apart = 0.0;
  Line up{.ink = Ink::first, .width = 1.8};
  Line down{.ink = Ink::first, .width = 1.8, .dashed = true};
  Line both{.ink = Ink::first, .label = "law", .width = 1.8};
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    const double total = rising.count[bin] + falling.count[bin];
    if (total == 0.0) continue;
    both.x.push_back(bins.middle(bin));
    both.y.push_back((rising.sum[bin] + falling.sum[bin]) / total);
    if (rising.count[bin] > 0.0) up.x.push_back(bins.middle(bin)), up.y.push_back(rising.mean(bin));
    if (falling.count[bin] > 0.0) down.x.push_back(bins.middle(bin)), down.y.push_back(falling.mean(bin));
    if (rising.count[bin] > 0.0 && falling.count[bin] > 0.0)
      apart = std::max(apart, std::abs(rising.mean(bin) - falling.mean(bin)));
  }
  if (apart <= kOneValued * (*most - *least) + kRounding * std::max(std::abs(*most), std::abs(*least))) {
    plot.marks.emplace_back(std::move(both));
    return;
  }
  up.label = "law, rising";
  down.label = "law, falling";
  plot.marks.emplace_back(std::move(up));
  plot.marks.emplace_back(std::move(down));
}

/// What the data demand over the state: 95 % of the points, with their own bands, of neighbours in the state.
Band demanded_band(const MissingTerm& term) {
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < std::min({term.state_value.size(), term.demanded.size(), term.band.size()}); ++k)
    if (std::isfinite(term.state_value[k] + term.demanded[k] + term.band[k])) order.push_back(k);
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return term.state_value[k]; });
  const std::size_t groups = std::clamp<std::size_t>(order.size() / kLeastPoints, 1, kBandGroups);
  Band band{.ink = Ink::muted, .label = "band"};
  for (std::size_t group = 0; group < groups; ++group) {
    const std::size_t begin = group * order.size() / groups, end = (group + 1) * order.size() / groups;
    double state = 0.0, sum = 0.0, squares = 0.0, errors = 0.0;
    for (std::size_t k = begin; k < end; ++k) {
      const std::size_t at = order[k];
      state += term.state_value[at], sum += term.demanded[at];
      squares += term.demanded[at] * term.demanded[at], errors += term.band[at] * term.band[at];
    }
    if (begin == end) continue;
    const auto count = static_cast<double>(end - begin);
    const double mean = sum / count, spread = std::max(squares / count - mean * mean, 0.0);
    const double half = std::sqrt(errors / count + kBand * kBand * spread);
    band.x.push_back(state / count);
    band.low.push_back(mean - half);
    band.high.push_back(mean + half);
  }
  return band;
}

Plot over_state(const MissingTerm& term) {
  Plot plot{.title = std::string("missing ").append(term.quantity),
            .x = {.label = term.state, .unit = term.state_unit},
            .y = {.unit = term.unit},
            .height = 240};
  Scatter dots{.ink = Ink::muted, .label = "required by data"};
  const std::size_t size = std::min(term.state_value.size(), term.demanded.size());
  const std::size_t step = size / kMostDots + 1;
  for (std::size_t k = 0; k < size; k += step) {
    dots.x.push_back(term.state_value[k]);
    dots.y.push_back(term.demanded[k]);
  }
  plot.marks.emplace_back(Reference{.at = 0.0});
  const auto [low, high] = std::minmax_element(term.state_value.begin(), term.state_value.end());
  if (size == term.band.size() && *high > *low) plot.marks.emplace_back(demanded_band(term));
  plot.marks.emplace_back(std::move(dots));
  if (has_law(term) && size == term.law.size() && *high > *low)
    add_law(term, {.low = *low, .step = (*high - *low) / static_cast<double>(kBins)}, plot);
  return plot;
}

/// Share of the points at which the law acts and runs inside the band.
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
      "Where the law acts, it lies inside the band at " + text::percent_text(inside) + " of the points.";
  if (inside < kMostlyOutside)
    words +=
        " Elsewhere a further effect is missing, or the law itself responds to the missing term (overflow, end stop, "
        "dry "
        "friction), which makes the band too narrow.";
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
      "The term that the data require is estimated without any law, from the recording and the element's balance, "
      "averaged over at least a quarter of a second. Shown is the recording in which the law acts most. The band is "
      "the "
      "95 % interval: inside it, law and data agree.",
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

// Does it help: recording, old and new simulation over each other, and the figures for each recording and channel.
#include <algorithm>
#include <cmath>

#include "services/common/report/explanation_sections.hpp"
#include "services/common/report/page.hpp"
#include "services/common/report/plot.hpp"
#include "services/common/text/estimates.hpp"
#include "services/common/text/readable.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::report {
namespace {

using mismatch::ChannelComparison;
using mismatch::Explanation;
using mismatch::RecordingComparison;

/// Plots end here, so that a page of many long recordings can still be sent by mail.
constexpr std::size_t kMostBytesOfPlots = 2'300'000;

bool kept_aside(const RecordingComparison& recording) { return recording.holdout || recording.left_out; }

std::string kind_of(const RecordingComparison& recording) {
  return recording.holdout ? "held out" : recording.left_out ? "left out in turn" : "fitted";
}

std::vector<const RecordingComparison*> kept_aside_first(const Explanation& explanation) {
  std::vector<const RecordingComparison*> order;
  for (const RecordingComparison& recording : explanation.recordings) order.push_back(&recording);
  std::ranges::stable_sort(order, {}, [](const RecordingComparison* one) { return !kept_aside(*one); });
  return order;
}

Plot overlay(const Series& recorded, const Series& before, const Series* after, const RecordingComparison& recording) {
  Plot plot{.title = text::in_words(recorded.name),
            .x = {.unit = "s", .tick_labels = false},
            .y = {.unit = recorded.unit},
            .height = 178};
  plot.marks.emplace_back(
      Line{.x = recording.recorded.time_s, .y = recorded.values, .ink = Ink::muted, .label = "recorded", .width = 2.6});
  plot.marks.emplace_back(Line{.x = recording.before.time_s,
                               .y = before.values,
                               .ink = after == nullptr ? Ink::first : Ink::second,
                               .label = after == nullptr ? "model" : "old model"});
  if (after != nullptr)
    plot.marks.emplace_back(
        Line{.x = recording.after.time_s, .y = after->values, .ink = Ink::first, .label = "new model"});
  return plot;
}

std::vector<double> residual(const Series& recorded, const Series& simulated) {
  const double unit = recorded.noise_std > 0.0 ? recorded.noise_std : 1.0;
  std::vector<double> difference;
  for (std::size_t k = 0; k < std::min(recorded.values.size(), simulated.values.size()); ++k)
    difference.push_back((recorded.values[k] - simulated.values[k]) / unit);
  return difference;
}

Plot residual_strip(const Series& recorded, const Series& before, const Series* after,
                    const RecordingComparison& recording) {
  const bool in_noise = recorded.noise_std > 0.0;
  Plot plot{.title = in_noise ? "recorded − simulated, in standard deviations of the noise" : "recorded − simulated",
            .x = {.label = "time", .unit = "s"},
            .y = {.unit = in_noise ? "1" : recorded.unit},
            .height = 124,
            .legend = false};
  plot.marks.emplace_back(Line{.x = recording.recorded.time_s,
                               .y = residual(recorded, before),
                               .ink = after == nullptr ? Ink::first : Ink::second,
                               .width = 1.0});
  if (after != nullptr)
    plot.marks.emplace_back(
        Line{.x = recording.recorded.time_s, .y = residual(recorded, *after), .ink = Ink::first, .width = 1.0});
  return plot;
}

/// One pair of plots for each channel that was simulated.
std::string overlays_of(const RecordingComparison& recording, bool changed) {
  std::string html;
  for (const Series& recorded : recording.recorded.channels) {
    const Series* before = recording.before.find(recorded.name);
    const Series* after = changed ? recording.after.find(recorded.name) : nullptr;
    if (before == nullptr) continue;
    Series with_noise = recorded;
    if (with_noise.noise_std <= 0.0) with_noise.noise_std = before->noise_std;
    html.append("<div>").append(to_svg(overlay(with_noise, *before, after, recording)));
    html.append(to_svg(residual_strip(with_noise, *before, after, recording))).append("</div>\n");
  }
  return html.empty() ? html : std::string("<div class=\"plots\">\n").append(html).append("</div>\n");
}

std::string change(const std::string& before, const std::string& after, bool changed) {
  return changed ? before + " → " + after : before;
}

/// "71.0 → 1.02", coloured where the change is more than 2 %.
std::string misfit_cell(const ChannelComparison& channel, bool changed) {
  std::string text =
      escaped(change(text::misfit_text(channel.rms_before), text::misfit_text(channel.rms_after), changed));
  const bool better = channel.rms_after < 0.98 * channel.rms_before;
  const bool worse = channel.rms_after > 1.02 * channel.rms_before;
  if (!changed || (!better && !worse)) return text;
  return std::string("<span class=\"").append(better ? "better" : "worse").append("\">").append(text).append("</span>");
}

void add_rows(const std::string& name, const std::string& kind, const std::vector<ChannelComparison>& channels,
              bool changed, Table& table) {
  bool first = true;
  for (const ChannelComparison& channel : channels) {
    const auto p = [changed](double before, double after) {
      return escaped(change(text::p_value_text(before), text::p_value_text(after), changed));
    };
    table.row_of_html({first ? std::string("<b>").append(escaped(name)).append("</b>") : std::string(),
                       first ? escaped(kind) : std::string(), escaped(text::in_words(channel.channel)),
                       misfit_cell(channel, changed),
                       escaped(change(text::number_text(channel.nrmse_before, 4),
                                      text::number_text(channel.nrmse_after, 4), changed)),
                       p(channel.whiteness_before, channel.whiteness_after),
                       p(channel.independence_before, channel.independence_after)});
    first = false;
  }
}

std::string gains(const Explanation& explanation) {
  Table table({"recording", "", ">likelihood gain", ">95 % interval", ""});
  for (const RecordingComparison* one : kept_aside_first(explanation)) {
    const RecordingComparison& recording = *one;
    const bool sure = recording.gain_low > 0.0;
    table.row({recording.recording, kind_of(recording), text::number_text(recording.likelihood_gain),
               text::number_text(recording.gain_low).append(" to ").append(text::number_text(recording.gain_high)),
               sure                        ? "improves"
               : recording.gain_high < 0.0 ? "gets worse"
                                           : "no clear change"});
  }
  return table.empty() ? std::string() : std::string("<h3>Gain of each recording</h3>\n").append(table.html());
}

}  // namespace

std::string overlays_section(const Explanation& explanation) {
  std::string html;
  std::size_t left_out = 0;
  bool first = true;
  for (const RecordingComparison* recording : kept_aside_first(explanation)) {
    if (html.size() > kMostBytesOfPlots) {
      ++left_out;
      continue;
    }
    const std::string plots = overlays_of(*recording, explanation.changed());
    if (plots.empty()) continue;
    const std::string label = recording->recording + ", " + kind_of(*recording);
    if (first || kept_aside(*recording))
      html.append("<h3>").append(escaped(label)).append("</h3>\n").append(plots);
    else
      html += folded("Plots of " + label, plots);
    first = false;
  }
  if (left_out > 0)
    html += paragraph("Plots of " + std::to_string(left_out) + " more recordings are omitted to keep this page small.",
                      "muted small");
  return html.empty()
             ? html
             : folded_section("Recording and simulation", "overlaid traces and residuals", html, Paper::printed);
}

std::string comparison_section(const Explanation& explanation) {
  const bool changed = explanation.changed();
  const std::vector<std::string> columns = {
      "recording", "", "channel", ">misfit / noise", ">fit, %", ">p, white", ">p, independent of input"};
  Table pooled(columns);
  pooled.keep_together();
  add_rows(explanation.holdout_recordings.empty() ? "all left out in turn" : "all held out", "",
           explanation.holdout.channels, changed, pooled);
  add_rows("all fitted", "", explanation.fit.channels, changed, pooled);
  Table each(columns);
  for (const RecordingComparison* recording : kept_aside_first(explanation))
    add_rows(recording->recording, kind_of(*recording), recording->channels, changed, each);
  std::string html;
  if (!pooled.empty()) html += pooled.html();
  if (!each.empty()) html += folded("Each recording", each.html());
  if (html.empty()) return {};
  if (changed) html += gains(explanation);
  return folded_section(changed ? "Before and after, in figures" : "The fit, in figures",
                        "misfit of each channel and recording", html, Paper::printed);
}

}  // namespace sealwatch::report

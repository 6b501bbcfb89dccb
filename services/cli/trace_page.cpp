#include "services/cli/trace_page.hpp"

#include <filesystem>

#include "services/cli/trace_words.hpp"
#include "services/common/report/page.hpp"
#include "services/common/report/plot.hpp"
#include "services/common/text/readable.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::cli {
namespace {

using report::Ink;
using trace::Alteration;
using trace::ChannelComparison;

report::Plot course(const trace::TraceComparison& comparison, const ChannelComparison& channel) {
  return {
      .title = text::in_words(channel.name),
      .x = {.label = "time", .unit = "s"},
      .y = {.label = text::in_words(channel.name), .unit = channel.unit},
      .marks =
          {report::Line{.x = comparison.time_s, .y = channel.recorded, .ink = Ink::foreground, .label = "recorded"},
           report::Line{
               .x = comparison.time_s, .y = channel.simulated, .ink = Ink::first, .label = "simulated", .width = 1.2}},
      .height = 190};
}

report::Plot difference(const trace::TraceComparison& comparison, const ChannelComparison& channel) {
  report::Line line{.x = comparison.time_s, .y = {}, .ink = Ink::second, .label = {}, .width = 0.9};
  for (std::size_t k = 0; k < channel.recorded.size(); ++k)
    line.y.push_back(channel.recorded[k] - channel.simulated[k]);
  return {.title = "recorded - simulated",
          .x = {.label = "time", .unit = "s"},
          .y = {.label = "difference", .unit = channel.unit},
          .marks = {line},
          .height = 190,
          .legend = false};
}

std::string alteration_table(const std::vector<Alteration>& alterations) {
  report::Table table({"~alteration", ">share of the misfit removed", "explains it"});
  for (const Alteration& alteration : alterations)
    table.row({alteration_text(alteration), text::percent_text(alteration.removed_share),
               alteration.would_do ? "yes" : "no"});
  return table.html();
}

std::string channel_part(const trace::TraceComparison& comparison, const ChannelComparison& channel) {
  const std::string finding = channel.differs ? "Differs beyond noise" : "No difference beyond noise";
  std::string body =
      report::paragraph(finding + std::string(" (p ") + text::p_value_text(channel.p_value) +
                        "): " + text::readable(channel.rms, channel.unit) + " rms, unexplained by any alteration " +
                        text::readable(channel.noise_std, channel.unit) + " with " +
                        text::number_text(channel.effective_samples) + " effective samples.");
  body += "<div class=\"plots\">";
  for (const report::Plot& plot : {course(comparison, channel), difference(comparison, channel)})
    body.append("<div>").append(report::to_svg(plot)).append("</div>");
  body += "</div>";
  if (!channel.differs) return report::folded_section(text::in_words(channel.name), "no difference beyond noise", body);
  report::Table regimes({"regime", ">share of the time", ">rms of the difference", ">share of the misfit"});
  for (const trace::RegimeMisfit& regime : channel.regimes)
    regimes.row({regime.name, text::percent_text(regime.time_share), text::readable(regime.rms, channel.unit),
                 text::percent_text(regime.misfit_share)});
  body += regimes.html();
  if (!channel.alterations.empty()) body += alteration_table(channel.alterations);
  return report::section(text::in_words(channel.name), body);
}

}  // namespace

std::string trace_page(const trace::TraceComparison& comparison, const std::string& recorded,
                       const std::string& simulated) {
  const auto file = [](const std::string& path) { return std::filesystem::path(path).filename().string(); };
  const bool alike = file(recorded) == file(simulated);  // of two folders
  const auto name = [&](const std::string& path) { return alike ? path : file(path); };
  std::string body = "<h1>Simulated trace against recording</h1>";
  body += report::paragraph("Simulated: " + name(simulated) + ". Recorded: " + name(recorded) + ".", "muted small");
  body.append("<div class=\"banner ").append(comparison.consistent ? "good" : "bad").append("\"><p class=\"verdict\">");
  body.append(report::escaped(trace_summary(comparison))).append("</p></div>");
  body += report::paragraph(trace_limit(), "muted");
  for (const bool differs : {true, false}) {
    for (const ChannelComparison& channel : comparison.channels)
      if (channel.differs == differs) body += channel_part(comparison, channel);
    if (differs && !comparison.common.empty())
      body += report::section("One cause for all channels", alteration_table(comparison.common));
  }
  return report::html_page("Simulated trace against recording", body);
}

}  // namespace sealwatch::cli

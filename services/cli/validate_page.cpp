#include "services/cli/validate_page.hpp"

#include <cctype>
#include <cmath>

#include "services/common/report/page.hpp"
#include "services/common/report/plot.hpp"
#include "services/common/text/estimates.hpp"
#include "services/common/text/readable.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::cli {
namespace {

using report::Ink;
using report::Plot;

constexpr double kNormal97_5 = 1.959963984540054;

Plot course(const RecordingValidation& recording, const ChannelValidation& channel) {
  return {
      .title =
          text::in_words(channel.fit.channel) + ", NRMSE " + text::number_text(channel.fit.nrmse_percent, 4) + " %",
      .x = {.label = "time", .unit = "s"},
      .y = {.label = text::in_words(channel.fit.channel), .unit = channel.unit},
      .marks =
          {report::Line{.x = recording.time_s, .y = channel.recorded, .ink = Ink::foreground, .label = "recorded"},
           report::Line{
               .x = recording.time_s, .y = channel.simulated, .ink = Ink::first, .label = "simulated", .width = 1.2}},
      .height = 170};
}

Plot residual(const RecordingValidation& recording, const ChannelValidation& channel) {
  const bool noise_known = channel.noise_std > 0.0;
  const double scale = noise_known ? channel.noise_std : 1.0;
  report::Line line{.x = recording.time_s, .y = {}, .ink = Ink::second, .label = {}, .width = 0.9};
  for (std::size_t k = 0; k < channel.recorded.size(); ++k)
    line.y.push_back((channel.recorded[k] - channel.simulated[k]) / scale);
  Plot plot{.title = noise_known ? "residual in noise standard deviations" : "residual",
            .x = {.label = "time", .unit = "s"},
            .y = {.label = "residual", .unit = noise_known ? "1" : channel.unit},
            .marks = {line},
            .height = 170,
            .legend = false};
  if (noise_known)
    for (const double limit : {-kNormal97_5, kNormal97_5}) plot.marks.emplace_back(report::Reference{.at = limit});
  return plot;
}

Plot autocorrelation(const ChannelValidation& channel) {
  report::Bars bars{.edges = {}, .heights = channel.autocorrelation, .ink = Ink::third, .label = {}};
  for (std::size_t lag = 0; lag <= bars.heights.size(); ++lag) bars.edges.push_back(static_cast<double>(lag) - 0.5);
  const double limit = kNormal97_5 / std::sqrt(static_cast<double>(channel.recorded.size()));
  return {.title = "autocorrelation of the residual",
          .x = {.label = "lag, samples", .unit = "1"},
          .y = {.label = "rho", .unit = "1", .range = std::pair{-0.5, 1.0}},
          .marks = {bars, report::Reference{.at = limit, .label = "95 %"}, report::Reference{.at = -limit}},
          .height = 170,
          .legend = false};
}

std::string channel_table(const RecordingValidation& recording) {
  report::Table table(
      {"channel", ">NRMSE %", ">noise of one sample", ">residual rms / noise", ">whiteness p", ">independence p"});
  for (const ChannelValidation& channel : recording.channels) {
    const bool noise_known = channel.noise_std > 0.0;
    table.row({text::in_words(channel.fit.channel), text::number_text(channel.fit.nrmse_percent, 4),
               noise_known ? text::readable(channel.noise_std, channel.unit) : "not known",
               noise_known ? text::misfit_text(channel.fit.noise_normalised_rms) : "–",
               text::p_value_text(channel.fit.whiteness_p), text::p_value_text(channel.fit.independence_p)});
  }
  return table.html();
}

std::string recording_part(const RecordingValidation& recording) {
  std::string plots;
  for (const ChannelValidation& channel : recording.channels) {
    plots.append("<h3>").append(report::escaped(text::in_words(channel.fit.channel))).append("</h3>");
    plots += "<div class=\"plots\">";
    for (const Plot& plot : {course(recording, channel), residual(recording, channel), autocorrelation(channel)})
      plots.append("<div>").append(report::to_svg(plot)).append("</div>");
    plots += "</div>";
  }
  return report::section(recording.recording, channel_table(recording) + plots);
}

std::string parameter_table(const ModelValidation& validation) {
  report::Table table({"parameter", ">value", ">standard error", "unit", "remark"});
  for (const EstimatedParameter& parameter : validation.parameters)
    table.row({parameter.name, text::number_text(parameter.value, 4), text::number_text(parameter.std_error, 2),
               text::unit_text(parameter.unit), parameter.at_bound ? "at its bound" : ""});
  return table.html();
}

std::string verdict(const ModelValidation& validation) {
  std::string html = "<div class=\"banner ";
  html += !validation.reasons.empty() ? "bad" : validation.remarks.empty() ? "good" : "warn";
  std::string words = verdict_in_words(validation);
  words.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(words.front())));
  html.append("\"><p class=\"verdict\">").append(report::escaped(words)).append(".</p>");
  if (!validation.reasons.empty() || !validation.remarks.empty()) html += "<ul>";
  for (const auto* list : {&validation.reasons, &validation.remarks})
    for (const std::string& reason : *list) html.append("<li>").append(report::escaped(reason)).append("</li>");
  if (!validation.reasons.empty() || !validation.remarks.empty()) html += "</ul>";
  return html + "</div>";
}

}  // namespace

const char* verdict_in_words(const ModelValidation& validation) {
  if (!validation.reasons.empty()) return "the simulation differs from the recordings";
  return validation.remarks.empty()
             ? "the simulation agrees with the recordings within their noise"
             : "no channel misfits by more than 3 times its noise, but what is left is more than noise";
}

const char* next_step(const ModelValidation& validation) {
  if (validation.reasons.empty() && validation.remarks.empty()) return "";
  return validation.fitted
             ? "Run sealwatch explain on several different tests: it names what the model lacks."
             : "Add --fit to estimate the free parameters. What they cannot explain, sealwatch explain names.";
}

std::string validation_page(const AssetConfig& asset, const ModelValidation& validation) {
  std::string body = "<h1>Model " + report::escaped(asset.model) + " against recordings of " +
                     report::escaped(asset.asset_id) + "</h1>" + verdict(validation);
  if (const std::string next = next_step(validation); !next.empty())
    body += "<div class=\"steps\"><h2>What to do next</h2>" + report::paragraph(next) + "</div>";
  body += report::paragraph(validation.fitted
                                ? "Parameters were estimated from these recordings, all together."
                                : "Parameters are those of the asset file; of each recording only the load and the "
                                  "initial state were estimated.");
  body += report::paragraph(
      "NRMSE 100 % is perfect, 0 no better than the mean. The residual's root mean square over the noise of one sample "
      "is "
      "1 when only noise is left; small p-values say that the residual is not white, or that it depends on the input.",
      "muted");
  if (!validation.parameters.empty())
    body += report::section("Parameters", parameter_table(validation) + report::paragraph(validation.termination));
  for (const RecordingValidation& recording : validation.recordings) body += recording_part(recording);
  return report::html_page("Model against recordings", body);
}

}  // namespace sealwatch::cli

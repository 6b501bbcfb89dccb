// Pictures that no recording is needed for, and those that are taken from pages of the program.
#include <array>
#include <stdexcept>

#include "sealwatch/message/topics.hpp"
#include "services/common/report/actuator_drawing.hpp"
#include "services/common/report/page.hpp"
#include "tests/figures/figures.hpp"

namespace sealwatch::figures {
namespace {

struct Layer {
  std::string_view name, concludes;
  std::vector<Topic> topics;
};

/// As docs/topics.md has them: what each passes to the next.
std::vector<Layer> all_layers() {
  return {{"data acquisition", "id of the test, channel status", {Topic::sample_block}},
          {"data manipulation", "window, phases, features", {Topic::test_window, Topic::test_features}},
          {"state detection", "alert regions, verdict, overdue", {Topic::state_report}},
          {"health assessment", "grade, likely faults, mismatch", {Topic::health_report}},
          {"prognostic assessment", "leakage, remaining life", {Topic::leakage_estimate, Topic::remaining_life}},
          {"advisory generation", "what to do, by when, why", {Topic::advisory}}};
}

constexpr std::array kFromOperators{Topic::acknowledgement, Topic::maintenance_event, Topic::model_acceptance};

std::string joined(const std::vector<Topic>& topics) {
  std::string text;
  for (const Topic topic : topics) text.append(text.empty() ? "" : ", ").append(name_of(topic));
  return text;
}

std::string box(double x, double y, double width, double height) {
  return "<rect class=\"part\" x=\"" + std::to_string(x) + "\" y=\"" + std::to_string(y) + "\" width=\"" +
         std::to_string(width) + "\" height=\"" + std::to_string(height) + "\" rx=\"5\"/>\n";
}

std::string arrow(double x, double from, double to) {
  const std::string at = std::to_string(x);
  return "<path class=\"wire\" d=\"M" + at + ' ' + std::to_string(from) + 'V' + std::to_string(to - 3.0) +
         "\"/><path d=\"M" + std::to_string(x - 5.0) + ' ' + std::to_string(to - 8.0) + 'L' + at + ' ' +
         std::to_string(to) + 'L' + std::to_string(x + 5.0) + ' ' + std::to_string(to - 8.0) +
         "Z\" style=\"fill:var(--muted)\"/>\n";
}

}  // namespace

std::string actuator() {
  const auto plant = find_plant("eha");
  if (!plant) throw std::runtime_error(plant.error().describe());
  std::vector<std::string> channels;
  for (const ChannelDescription& channel : (*plant)->channels) channels.push_back(channel.name);
  Canvas canvas("The actuator with the names of its elements", 960, 376);
  canvas.place(report::actuator_drawing(**plant, {}, channels), 0.0, 0.0);
  return canvas.svg();
}

std::string layers() {
  constexpr double kStep = 74.0, kHeight = 44.0, kWidth = 400.0, kLeft = 20.0, kMiddle = kLeft + 0.5 * kWidth;
  const std::vector<Layer> layers = all_layers();
  Canvas canvas("The six layers with their topics", 760,
                static_cast<int>(kStep * static_cast<double>(layers.size() + 2)));
  double y = 14.0;
  const auto node = [&](std::string_view name, std::string_view says, std::string_view topics) {
    canvas.raw(box(kLeft, y, kWidth, kHeight));
    canvas.text(name, kMiddle, y + 18.0, "title", "middle");
    canvas.text(says, kMiddle, y + 35.0, "tick", "middle");
    canvas.raw(arrow(kMiddle, y + kHeight, y + kStep));
    canvas.text(topics, kMiddle + 14.0, y + kHeight + 19.0);
    y += kStep;
  };
  node("Master Control System, virtual bench, sealwatch replay", "run the tests", name_of(Topic::raw_samples));
  for (const Layer& layer : layers) node(layer.name, layer.concludes, joined(layer.topics));
  canvas.raw(box(kLeft, y, kWidth, kHeight));
  canvas.text("operators' systems, sealwatch status and watch", kMiddle, y + 18.0, "title", "middle");
  canvas.text("and a subscriber of your own", kMiddle, y + 35.0, "tick", "middle");
  const double right = kLeft + kWidth + 26.0;
  canvas.text("from prognosis to the Master Control System:", right, 30.0, "tick");
  canvas.text(name_of(Topic::pst_request), right, 46.0, "title");
  canvas.text("from health assessment to operators:", right, y - 40.0, "tick");
  canvas.text(name_of(Topic::model_discrepancy), right, y - 24.0, "title");
  canvas.text("from operators to the layers:", right, y, "tick");
  double line = y + 16.0;
  for (const Topic topic : kFromOperators) {
    canvas.text(name_of(topic), right, line, "title");
    line += 15.0;
  }
  return canvas.svg();
}

std::string first_screen(const std::string& report_page) {
  constexpr int kWidth = 1180, kHeight = 716;
  Canvas canvas("The first screen of a report", kWidth, kHeight);
  canvas.raw("<foreignObject x=\"0\" y=\"0\" width=\"" + std::to_string(kWidth) + "\" height=\"" +
             std::to_string(kHeight) + "\"><body xmlns=\"http://www.w3.org/1999/xhtml\">\n" +
             between(report_page, "<body>", "<section") + "</body></foreignObject>\n");
  return canvas.svg();
}

std::string before_and_after(const std::string& report_page, const std::string& channel) {
  constexpr double kColumn = 470.0;
  Canvas canvas("Recording, old and new simulation, and the missing term with its law", 950, 330);
  constexpr std::string_view kOverlays = "<h2>Recording and simulation</h2>";
  constexpr std::string_view kMissing = "<h2>The missing term</h2>";
  canvas.place(drawing_in(report_page, kOverlays, "<title>" + channel), 0.0, 0.0);
  canvas.place(drawing_in(report_page.substr(report_page.find("<title>" + channel, report_page.find(kOverlays))), "",
                          "recorded − simulated"),
               0.0, 186.0);
  canvas.place(drawing_in(report_page, kMissing, "<title>missing"), kColumn, 0.0);
  canvas.text(between(report_page, "<div class=\"screen\">\n<div>\n<h2>What the model lacks</h2>\n<h3>", "</h3>"),
              kColumn + 54.0, 272.0, "title");
  canvas.text(between(report_page, "<span class=\"law\">", "</span>") + ",  " +
                  between(report_page, "</span></p>\n<p>", "</p>"),
              kColumn + 54.0, 292.0);
  return canvas.svg();
}

std::string forecast_curve(const std::string& forecast_page) {
  Canvas canvas("Seal condition over the years, forecast and end of life", 980, 300);
  canvas.place(drawing_in(forecast_page, "<body>", "Seal condition"), 0.0, 0.0);
  return canvas.svg();
}

}  // namespace sealwatch::figures

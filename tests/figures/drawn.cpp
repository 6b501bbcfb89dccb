// Pictures that no recording is needed for, and those that are taken from pages of the program.
#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <stdexcept>

#include "sealwatch/message/topics.hpp"
#include "services/common/report/actuator_drawing.hpp"
#include "services/common/report/page.hpp"
#include "tests/figures/figures.hpp"
#include "tests/figures/page_screen.hpp"

namespace sealwatch::figures {
namespace {

// Boxes from top to bottom: what runs the tests, the six layers, the operators.
enum Node : std::size_t { control, acquisition, manipulation, detection, health, prognosis, advice, operators, kNodes };

struct Box {
  std::string_view name, says;
  std::vector<Topic> next = {};  ///< what it passes to the box below
  std::vector<Topic> back = {};  ///< what it gets from there
};

/// As docs/topics.md has them.
std::array<Box, kNodes> all_boxes() {
  return {{{"Master Control System, virtual bench, sealwatch replay", "run the tests", {Topic::raw_samples}},
           {"data acquisition", "id of the test, channel status", {Topic::sample_block}},
           {"data manipulation", "window, phases, features", {Topic::test_window, Topic::test_features}},
           {"state detection", "alert regions, verdict, overdue", {Topic::state_report}},
           {"health assessment", "grade, likely faults, mismatch", {Topic::health_report}},
           {"prognostic assessment", "leakage, remaining life", {Topic::leakage_estimate, Topic::remaining_life}},
           {"advisory generation", "what to do, by when, why", {Topic::advisory}, {Topic::acknowledgement}},
           {"operators' systems, sealwatch status and watch", "and a subscriber of your own"}}};
}

/// A topic that goes elsewhere than to the next box.
struct Route {
  Topic topic;
  Node from;
  std::vector<Node> to;
  std::string_view also = {};  ///< a topic of the same messages with a right of its own
};

std::vector<Route> all_routes() {
  return {{Topic::test_features, manipulation, {health}},
          {Topic::health_report, health, {advice}},
          {Topic::test_window, manipulation, {health, prognosis}},
          {Topic::model_discrepancy, health, {detection, prognosis, operators}},
          {Topic::state_report, detection, {advice}},
          {Topic::model_acceptance, operators, {detection, prognosis}},
          {Topic::pst_request, prognosis, {control}},
          {Topic::maintenance_event, operators, {acquisition, detection, prognosis, advice}, ", retraction"}};
}

/// Of the topics that carry assets' data, between the services alone; heartbeats and requests for repetition, too.
constexpr std::array kAmongServices = {Topic::act_record};
constexpr std::string_view kAlsoAmongServices = ", service_status, resend_request";

/// A picture without one of the topics is not drawn.
void expect_all_topics(const std::array<Box, kNodes>& boxes, const std::vector<Route>& routes) {
  std::set<Topic> drawn(kAmongServices.begin(), kAmongServices.end());
  for (const Box& box : boxes) {
    drawn.insert(box.next.begin(), box.next.end());
    drawn.insert(box.back.begin(), box.back.end());
  }
  for (const Route& route : routes) drawn.insert(route.topic);
  if (drawn.size() != EnumNames<Topic>::kNames.size())
    throw std::runtime_error("the picture of the layers lacks a topic: add it to the boxes or routes");
}

constexpr double kStep = 84.0, kHeight = 52.0, kWidth = 380.0, kLeft = 20.0, kTop = 14.0;
constexpr double kLine = 16.0;  // of words beside a box

constexpr int kScreenWidth = 1180;  // of the pages

std::string joined(const std::vector<Topic>& topics) {
  std::string text;
  for (const Topic topic : topics) text.append(text.empty() ? "" : ", ").append(name_of(topic));
  return text;
}

std::string box(double x, double y, double width, double height) {
  return "<rect class=\"part\" x=\"" + std::to_string(x) + "\" y=\"" + std::to_string(y) + "\" width=\"" +
         std::to_string(width) + "\" height=\"" + std::to_string(height) + "\" rx=\"5\"/>\n";
}

/// Down or up, whichever `to` is.
std::string arrow(double x, double from, double to, const std::string& ink = "--muted") {
  const std::string at = std::to_string(x);
  const double down = to > from ? 1.0 : -1.0;
  const std::string shoulder = ' ' + std::to_string(to - 8.0 * down);
  return "<path class=\"wire\" style=\"stroke:var(" + ink + ")\" d=\"M" + at + ' ' + std::to_string(from) + 'V' +
         std::to_string(to - 3.0 * down) + "\"/><path d=\"M" + std::to_string(x - 5.0) + shoulder + 'L' + at + ' ' +
         std::to_string(to) + 'L' + std::to_string(x + 5.0) + shoulder + "Z\" style=\"fill:var(" + ink + ")\"/>\n";
}

/// Topics that a box writes or reads beside those of the arrows.
std::string topics_of(const std::vector<Route>& routes, const auto& chosen) {
  std::string text;
  for (const Route& route : routes)
    if (chosen(route)) text.append(text.empty() ? "" : ", ").append(name_of(route.topic)).append(route.also);
  return text;
}

/// Up to three lines on the right of a box whose top is `y`: what it also reads, gets from people, and also sends.
void draw_other_topics(Node node, double y, const std::vector<Route>& routes, Canvas& canvas) {
  const auto read = [&](const Route& route) { return std::ranges::find(route.to, node) != route.to.end(); };
  const auto by_people = [](const Route& route) { return route.from == operators; };
  // What the arrows pass on needs no second word.
  const std::array<Box, kNodes> boxes = all_boxes();
  const auto passed_on = [&](const Route& route) {
    return std::ranges::find(boxes[route.from].next, route.topic) != boxes[route.from].next.end();
  };
  struct Words {
    std::string_view begin, ink;
    std::string topics;
  };
  const std::array<Words, 3> lines{{
      {"also reads ", "--first", topics_of(routes, [&](const Route& r) { return read(r) && !by_people(r); })},
      {"from people: ", "--second", topics_of(routes, [&](const Route& r) { return read(r) && by_people(r); })},
      {"also sends ", node == operators ? "--second" : "--muted",
       topics_of(routes, [&](const Route& r) { return r.from == node && !passed_on(r); })},
  }};
  const auto count = std::ranges::count_if(lines, [](const Words& words) { return !words.topics.empty(); });
  double baseline = y + 0.5 * kHeight + 4.0 - 0.5 * kLine * static_cast<double>(count - 1);
  for (const Words& words : lines) {
    if (words.topics.empty()) continue;
    canvas.raw("<text x=\"" + std::to_string(kLeft + kWidth + 16.0) + "\" y=\"" + std::to_string(baseline) +
               "\" style=\"fill:var(" + std::string(words.ink) + ")\">" + std::string(words.begin) + words.topics +
               "</text>\n");
    baseline += kLine;
  }
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
  constexpr double kMiddle = kLeft + 0.5 * kWidth, kBack = kLeft + 0.7 * kWidth;
  constexpr double kWords = 0.5 * (kStep - kHeight) + 4.0;  // under a box, beside its arrow
  const std::array<Box, kNodes> boxes = all_boxes();
  const std::vector<Route> routes = all_routes();
  expect_all_topics(boxes, routes);
  Canvas canvas("The six layers with their topics", 860, static_cast<int>(kStep * static_cast<double>(kNodes)) + 22);
  double y = kTop;
  for (std::size_t node = 0; node < kNodes; ++node, y += kStep) {
    const Box& one = boxes[node];
    canvas.raw(box(kLeft, y, kWidth, kHeight));
    canvas.text(one.name, kMiddle, y + 22.0, "title", "middle");
    canvas.text(one.says, kMiddle, y + 39.0, "tick", "middle");
    if (!one.next.empty()) {
      canvas.raw(arrow(kMiddle, y + kHeight, y + kStep));
      canvas.text(joined(one.next), kMiddle + 14.0, y + kHeight + kWords);
    }
    if (!one.back.empty()) {
      canvas.raw(arrow(kBack, y + kStep, y + kHeight, "--second"));
      canvas.text(joined(one.back), kBack + 14.0, y + kHeight + kWords);
    }
    draw_other_topics(static_cast<Node>(node), y, routes, canvas);
  }
  canvas.text("all services: " + joined({kAmongServices.begin(), kAmongServices.end()}).append(kAlsoAmongServices),
              kLeft, y, "tick");
  return canvas.svg();
}

std::string first_screen(const std::string& report_page) {
  return page_screen("The first screen of a report", between(report_page, "<body>", "<section"), kScreenWidth);
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
  // The second plot of the term: over what it depends on.
  const std::size_t over_time = report_page.find("<title>missing", report_page.find(kMissing));
  canvas.place(drawing_in(report_page.substr(over_time), "", "<title>missing"), kColumn, 0.0);
  canvas.text(between(report_page, "<div class=\"screen\">\n<div>\n<h2>What the model lacks</h2>\n<h3>", "</h3>"),
              kColumn + 54.0, 272.0, "title");
  canvas.text(between(report_page, "<span class=\"law\">", "</span>") + ",  " +
                  between(report_page, "</span></p>\n<p>", "</p>"),
              kColumn + 54.0, 292.0);
  return canvas.svg();
}

std::string forecast_screen(const std::string& forecast_page) {
  return page_screen("The forecast page: what to do, by when, and why",
                     between(forecast_page, "<body>", "<div class=\"narrow\">"), kScreenWidth);
}

}  // namespace sealwatch::figures

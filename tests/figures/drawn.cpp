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

/// The short ones first: they get the lanes next to the boxes.
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

// The step leaves a topic's name room between the lines of one box and those of the next.
constexpr double kStep = 100.0, kHeight = 52.0, kWidth = 400.0, kLeft = 20.0, kTop = 14.0;
constexpr double kLane = 27.0, kPort = 10.4;  // between lines side by side

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

/// Of a topic's name at 11 px.
double width_of(std::string_view name) {
  constexpr std::string_view kWide = "mw", kNarrow = "fijlrt";
  double pixels = 0.0;
  for (const char letter : name)
    pixels += kWide.find(letter) != kWide.npos ? 9.9 : kNarrow.find(letter) != kNarrow.npos ? 3.9 : 6.5;
  return pixels;
}

/// Routes on the right of the boxes: each topic in a lane of its own, with an arrow into each of its readers.
class Lanes {
 public:
  explicit Lanes(const std::vector<Route>& routes) {
    for (const Route& route : routes) {
      ++ports_[route.from];
      for (const Node node : route.to) ++ports_[node];
    }
  }
  void draw(const Route& route, Canvas& canvas) {
    const std::string ink = route.from == operators ? "--second" : "--first";
    const double begin = next_port(route.from);
    double high = begin, low = begin;
    std::vector<double> ends;
    for (const Node node : route.to) {
      ends.push_back(next_port(node));
      high = std::min(high, ends.back()), low = std::max(low, ends.back());
    }
    const double lane = kLeft + kWidth + kLane * (1.0 + static_cast<double>(free_lane(high, low)));
    std::string path =
        "M" + at(kLeft + kWidth) + at(begin) + "H" + at(lane) + "M" + at(lane) + at(high) + "V" + at(low);
    std::string heads;
    crossings_.push_back({.lane = lane, .height = begin});
    for (const double end : ends) {
      crossings_.push_back({.lane = lane, .height = end});
      path += "M" + at(lane) + at(end) + "H" + at(kLeft + kWidth + 6.0);
      heads += "M" + at(kLeft + kWidth) + at(end) + "l8-4v8Z";
    }
    canvas.raw("<path d=\"" + path + "\" style=\"fill:none;stroke:var(" + ink + ");stroke-width:1.4\"/>\n<path d=\"" +
               heads + "\" style=\"fill:var(" + ink + ")\"/>\n");
    names_.push_back({.text = std::string(name_of(route.topic)).append(route.also),
                      .ink = ink,
                      .lane = lane,
                      .high = high,
                      .low = low});
  }
  /// The topics' names, to be drawn over all lines: each beside its lane where the fewest lines pass through it.
  [[nodiscard]] std::string names() const {
    std::string svg;
    for (const Name& name : names_)
      svg += "<text class=\"named\" text-anchor=\"middle\" transform=\"translate(" + at(name.lane + 12.0) +
             at(clear_height(name)) + ") rotate(-90)\" style=\"fill:var(" + name.ink + ")\">" + name.text + "</text>\n";
    return svg;
  }

 private:
  struct Name {
    std::string text, ink;
    double lane, high, low;
  };
  /// A line from the boxes to a lane.
  struct Crossing {
    double lane, height;
  };

  [[nodiscard]] double clear_height(const Name& name) const {
    constexpr double kOverhang = 12.0, kClear = 3.0;
    const double half = 0.5 * width_of(name.text) + kClear;
    const double middle = 0.5 * (name.high + name.low);
    const auto passing = [&](double height) {
      return std::ranges::count_if(crossings_, [&](const Crossing& line) {
        return line.lane > name.lane + 4.0 && std::abs(line.height - height) < half;
      });
    };
    double best = middle;
    for (double away = 1.0; name.high + half <= middle - away + kOverhang; away += 1.0)
      for (const double height : {middle - away, middle + away})
        if (passing(height) < passing(best)) best = height;
    return best;
  }
  static std::string at(double pixels) { return std::to_string(std::lround(pixels)) + ' '; }
  double next_port(Node node) {
    const double apart = std::min(kPort, kHeight / static_cast<double>(ports_[node] + 1));
    const double from_middle = static_cast<double>(++used_[node]) - 0.5 * static_cast<double>(ports_[node] + 1);
    return kTop + kStep * static_cast<double>(node) + 0.5 * kHeight + apart * from_middle;
  }
  /// The first in which nothing else is between the two heights.
  std::size_t free_lane(double high, double low) {
    std::size_t lane = 0;
    const auto apart = [&](const std::pair<double, double>& other) { return low < other.first || high > other.second; };
    while (lane < taken_.size() && !std::ranges::all_of(taken_[lane], apart)) ++lane;
    if (lane == taken_.size()) taken_.emplace_back();
    taken_[lane].emplace_back(high, low);
    return lane;
  }

  std::vector<Name> names_;
  std::vector<Crossing> crossings_;
  std::array<int, kNodes> ports_{}, used_{};
  std::vector<std::vector<std::pair<double, double>>> taken_;
};

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
  Canvas canvas("The six layers with their topics", 700, static_cast<int>(kStep * static_cast<double>(kNodes)) + 24);
  double y = kTop;
  for (const Box& one : boxes) {
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
    y += kStep;
  }
  const std::vector<Route> routes = all_routes();
  expect_all_topics(boxes, routes);
  canvas.text(
      "among the services: " + joined({kAmongServices.begin(), kAmongServices.end()}).append(kAlsoAmongServices), kLeft,
      y, "tick");
  Lanes lanes(routes);
  for (const Route& route : routes) lanes.draw(route, canvas);
  canvas.raw(lanes.names());
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
  canvas.place(drawing_in(report_page, kMissing, "<title>missing"), kColumn, 0.0);
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

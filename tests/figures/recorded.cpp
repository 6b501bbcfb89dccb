// Pictures of recordings: one partial stroke with its phases, what it shows of the valve, and what the position loop
// hides.
#include <algorithm>
#include <utility>

#include "sealwatch/signal/test_record.hpp"
#include "services/common/report/plot.hpp"
#include "tests/figures/figures.hpp"

namespace sealwatch::figures {
namespace {

using report::Ink;
using report::Line;
using report::Plot;
using signal::MotionKind;

constexpr int kWide = 980;
constexpr int kHalf = 485;

std::string name_of(MotionKind kind) {
  switch (kind) {
    case MotionKind::rest:
      return "rest";
    case MotionKind::breakaway:
      return "breakaway";
    case MotionKind::out:
      return "out";
    case MotionKind::hold:
      return "hold";
    case MotionKind::back:
      return "back";
  }
  return {};
}

signal::TestRecord record_of(const Recording& recording) {
  signal::Cylinder cylinder;
  cylinder.area_a_m2 = 5.89e-3;  // as config/assets/xt03-mv2.yaml has them
  cylinder.stroke_m = 0.08;
  return {recording.samples, cylinder, plant_or_default({})};
}

Line line_of(const TimeSeries& samples, const std::vector<double>& values, Ink ink, std::string label = {}) {
  return {.x = samples.time_s, .y = values, .ink = ink, .label = std::move(label)};
}

Plot over_time(std::string title, std::string unit, int width, int height) {
  return {.title = std::move(title),
          .x = {.label = "time", .unit = "s"},
          .y = {.unit = std::move(unit)},
          .width = width,
          .height = height};
}

}  // namespace

std::string partial_stroke(const Recording& recording) {
  constexpr int kHeight = 176;
  const signal::TestRecord test = record_of(recording);
  const TimeSeries& samples = recording.samples;
  Canvas canvas("One partial stroke test with its phases", kWide, 3 * kHeight);
  double y = 0.0;
  const auto add = [&](const std::string& title, const std::string& unit, const std::vector<double>& values) {
    const bool first = y == 0.0, second = y == kHeight;
    Plot plot = over_time(title, unit, kWide, kHeight);
    if (first) plot.y.range = {0.042, 0.066};  // room for the names above the curve
    for (const signal::MotionPhase& phase : test.phases()) {
      const bool named = first != (phase.kind == MotionKind::breakaway);  // too short for its name beside the next
      plot.marks.emplace_back(
          report::Reference{.at = phase.begin_s,
                            .vertical = true,
                            .label = named && (first || second) ? name_of(phase.kind) : std::string()});
    }
    plot.marks.emplace_back(line_of(samples, values, Ink::first));
    canvas.place(report::to_svg(plot), 0.0, y);
    y += kHeight;
  };
  add("position", "m", samples.find("position")->values);
  add("load pressure, chamber A minus chamber B (low-passed)", "Pa", test.smooth_load_pressure());
  add("motor current (low-passed)", "A", *test.smooth(ChannelRole::current));
  return canvas.svg();
}

std::string valve_signature(const Recording& recording) {
  const signal::TestRecord test = record_of(recording);
  Plot plot{.title = "load pressure over position (the gap between out and back is friction)",
            .x = {.label = "position", .unit = "m"},
            .y = {.unit = "Pa"},
            .width = kWide,
            .height = 340};
  const auto& position = test.position();
  const auto& pressure = test.smooth_load_pressure();
  // Room at both ends, where the pressure changes at rest: on the frame that would not be seen.
  const auto [least, largest] = std::ranges::minmax(position);
  const double room = 0.02 * (largest - least);
  plot.x.range = {least - room, largest + room};
  std::string at_rest = "rest and hold";  // in the legend once
  for (const signal::MotionPhase& phase : test.phases()) {
    const signal::Range range = test.range(phase);
    Line line{.label = name_of(phase.kind)};
    line.x.assign(position.begin() + static_cast<std::ptrdiff_t>(range.begin),
                  position.begin() + static_cast<std::ptrdiff_t>(range.end));
    line.y.assign(pressure.begin() + static_cast<std::ptrdiff_t>(range.begin),
                  pressure.begin() + static_cast<std::ptrdiff_t>(range.end));
    switch (phase.kind) {
      case MotionKind::out:
        line.ink = Ink::first;
        break;
      case MotionKind::back:
        line.ink = Ink::second;
        break;
      case MotionKind::breakaway:
        line.ink = Ink::third;
        line.width = 2.6;
        break;
      default:
        line.ink = Ink::muted;
        line.label = std::exchange(at_rest, std::string());
    }
    plot.marks.emplace_back(std::move(line));
  }
  Canvas canvas("Valve signature", plot.width, plot.height);
  canvas.place(report::to_svg(plot), 0.0, 0.0);
  return canvas.svg();
}

std::string concealed_effect(const Recording& plain, const Recording& hidden) {
  constexpr int kHeight = 250;
  Canvas canvas("An effect that the position loop conceals", 2 * kHalf, kHeight);
  double x = 0.0;
  const auto add = [&](Plot plot, const std::vector<double>& without, const std::vector<double>& with) {
    plot.marks.emplace_back(Line{
        .x = plain.samples.time_s, .y = without, .ink = Ink::muted, .label = "without dry friction", .width = 3.0});
    plot.marks.emplace_back(line_of(hidden.samples, with, Ink::second, "with 4 kN of dry friction"));
    canvas.place(report::to_svg(plot), x, 0.0);
    x += kHalf;
  };
  add(over_time("position (the loop hides the friction)", "m", kHalf, kHeight), plain.samples.find("position")->values,
      hidden.samples.find("position")->values);
  add(over_time("load pressure (it shows the friction)", "Pa", kHalf, kHeight), record_of(plain).smooth_load_pressure(),
      record_of(hidden).smooth_load_pressure());
  return canvas.svg();
}

}  // namespace sealwatch::figures

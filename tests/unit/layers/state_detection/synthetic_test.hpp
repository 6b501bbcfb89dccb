// A partial stroke test made up from the steady-state balances of docs/model.md, with faults of the actuator and of
// its sensors put in at the physics, so that what a layer finds is not what the test told it.
//
//   q_h = dp/R, q = A v + dp/R, omega = (q + slip dp)/alpha_P, i = (alpha_P dp + drag omega)/T_M, u = emf omega + R_M i
#pragma once

#include <cmath>
#include <functional>
#include <random>
#include <string>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/core/time.hpp"
#include "sealwatch/message/data_manipulation.hpp"
#include "sealwatch/message/made_up.hpp"

namespace sealwatch::synthetic {

inline constexpr double kArea = 5.89e-3, kAlpha = 3.98e-8, kTorque = 0.2, kWinding = 0.5, kSpeed = 1.33e-3;

inline AssetConfig asset(const std::string& id = "A1") {
  AssetConfig a;
  a.asset_id = id;
  const auto set = [&](const char* name, double value) { a.parameters[name] = {value, value / 10, value * 10, false}; };
  set("A_C", kArea);
  set("alpha_P", kAlpha);
  set("T_M", kTorque);
  set("R_M", kWinding);
  set("Omega_M", 0.2);
  set("f_M", 8e-4);
  set("d_P", 2e-4);
  set("R_PL", 5e13);
  set("R_CL", 2.6e13);
  set("phi", 6e4);
  set("x_C", 0.08);
  a.condition = ConditionSetting{
      .parameter = "R_CL", .at_100 = 2.6e13, .at_60 = 4.64e12, .unit = "Pa s/m3", .part = "piston seal"};
  return a;
}

/// The actuator and its sensors during one test. Defaults are a healthy one with half of its seal's life gone.
struct Condition {
  double load_factor = 0.0;
  double theta = 0.85;
  double friction_N = 2400.0;
  double breakaway_extra_Pa = 0.0;
  double slip = 2e-14;
  double drag = 1e-3;
  double emf = 0.2;
  double flow_gain = 1.0, flow_bias = 0.0, pressure_a_bias = 0.0, speed_gain = 1.0, current_gain = 1.0,
         voltage_gain = 1.0, position_gain = 1.0, velocity_gain = 1.0;
  double stroke_m = 0.016;
  double speed_m_s = kSpeed;
};

/// What the test's messages say about it.
struct Circumstances {
  std::string asset_id = "A1";
  int number = 0;  ///< gives pst_id and, where known, the event time: one test a month
  bool event_time_known = true;
  bool replay = false;
  std::string test_kind = "pst";
  bool aborted = false;
  double cut_after_s = 0.0;    ///< 0: whole
  std::string failed_channel;  ///< status FAILED
  std::string absent_channel;  ///< not recorded
  double temperature_deviation_K = 0.0;
  double drive_saturation = 0.0;
  double missing_share = 0.0;
  double extra_days = 0.0;  ///< shifts the event time
};

struct Test {
  TestFeatures features;
  TestWindow window;
};

inline UtcTime month(int number, double extra_days = 0.0) {
  const UtcTime start = *parse_utc("2031-01-10T03:00:00Z");
  return add_seconds(add_months(start, number), extra_days * kSecondsPerDay);
}

namespace detail {

struct Steady {
  double v, dp, q, omega, i, u;
};

inline Steady steady(const Condition& c, double v) {
  const double force = 6e4 * (1 + c.load_factor) + (v > 0 ? c.friction_N : v < 0 ? -c.friction_N : 0.0);
  Steady s{};
  s.v = v;
  s.dp = force / kArea;
  s.q = kArea * v +
        s.dp /
            ConditionSetting{
                .parameter = "R_CL", .at_100 = 2.6e13, .at_60 = 4.64e12, .unit = "Pa s/m3", .part = "piston seal"}
                .value(c.theta);
  s.omega = (s.q + c.slip * s.dp) / kAlpha;
  s.i = (kAlpha * s.dp + c.drag * s.omega) / kTorque;
  s.u = c.emf * s.omega + kWinding * s.i;
  return s;
}

struct Segment {
  PhaseKind kind;
  double begin_s, end_s, v;
};

}  // namespace detail

inline Test make(const Condition& c, const Circumstances& w) {
  using detail::Steady;
  Test test;
  const double stroke_s = c.stroke_m / c.speed_m_s;
  const std::vector<detail::Segment> segments = {{PhaseKind::rest, 0, 0.8, 0},
                                                 {PhaseKind::breakaway, 0.8, 1, 0},
                                                 {PhaseKind::out, 1, 1 + stroke_s, -c.speed_m_s},
                                                 {PhaseKind::hold, 1 + stroke_s, 4 + stroke_s, 0},
                                                 {PhaseKind::back, 4 + stroke_s, 4 + 2 * stroke_s, c.speed_m_s},
                                                 {PhaseKind::hold, 4 + 2 * stroke_s, 7 + 2 * stroke_s, 0}};
  const double whole_s = segments.back().end_s;
  const double end_s = w.cut_after_s > 0 ? w.cut_after_s : whole_s;

  TestWindow& window = test.window;
  const std::vector<std::string> names = {"motor_voltage", "motor_current", "shaft_speed", "pressure_a",
                                          "pressure_b",    "flow",          "position",    "velocity"};
  const std::vector<double> noise = {0.01, 0.02, 0.5, 1e4, 1e4, 4e-8, 5e-6, 1e-5};
  for (std::size_t k = 0; k < names.size(); ++k) window.samples.channels.push_back({names[k], "", noise[k], {}});
  std::mt19937 random(static_cast<unsigned>(w.number + 17));
  std::normal_distribution<double> normal;
  double x = 0.06;
  const double dt = 0.02;
  std::size_t segment = 0;
  for (double t = 0; t < end_s; t += dt) {
    while (segment + 1 < segments.size() && t >= segments[segment].end_s) ++segment;
    const Steady s = detail::steady(c, segments[segment].v);
    x += s.v * dt;
    const double values[] = {c.voltage_gain * s.u,
                             c.current_gain * s.i,
                             c.speed_gain * s.omega,
                             s.dp + 3e6 + c.pressure_a_bias,
                             3e6,
                             c.flow_gain * s.q + c.flow_bias,
                             c.position_gain * x,
                             c.velocity_gain * s.v};
    window.samples.time_s.push_back(t);
    for (std::size_t k = 0; k < names.size(); ++k)
      window.samples.channels[k].values.push_back(values[k] + noise[k] * normal(random));
  }
  std::erase_if(window.samples.channels,
                [&](const Series& s) { return s.name == w.absent_channel || s.name == w.failed_channel; });

  Header header;
  header.pst_id = w.asset_id + "-" + std::to_string(w.number);
  header.event_time_known = w.event_time_known;
  if (w.event_time_known) header.event_time_ns = month(w.number, w.extra_days).nanoseconds;
  header.replay = w.replay;
  header.source_ids = {"sample_block/" + header.pst_id + "/0"};
  window.asset_id = w.asset_id;
  window.header = header;
  window.header.message_id = "test_window/" + header.pst_id;
  window.test_kind = w.test_kind;
  window.complete = !w.aborted;
  window.aborted = w.aborted;
  window.missing_share = w.missing_share;
  for (const std::string& name : names)
    if (name != w.absent_channel)
      window.channel_status.push_back({name, name == w.failed_channel ? ChannelState::FAILED : ChannelState::OK,
                                       name == w.failed_channel ? "frozen for 4.0 s from 2.0 s" : ""});
  for (const detail::Segment& s : segments)
    if (s.begin_s < end_s) window.phases.push_back({s.kind, s.begin_s, std::min(s.end_s, end_s)});

  TestFeatures& f = test.features;
  f.asset_id = w.asset_id;
  f.header = header;
  f.header.message_id = "test_features/" + header.pst_id;
  f.header.source_ids.push_back(window.header.message_id);
  f.test_kind = w.test_kind;
  f.complete = window.complete;
  f.aborted = w.aborted;
  if (w.aborted) f.abort_reason = "MCS command had priority";
  f.duration_s = end_s;
  f.channel_status = window.channel_status;
  f.phases = window.phases;
  const auto has = [&](const char* name) { return name != w.failed_channel && name != w.absent_channel; };
  const auto add = [&](const char* name, double value) { f.features.push_back({name, "", value, false, 0.0}); };
  const Steady out = detail::steady(c, -c.speed_m_s), back = detail::steady(c, c.speed_m_s),
               hold = detail::steady(c, 0);
  const bool whole = end_s >= whole_s;
  if (has("position") || has("velocity")) {  // without the position data manipulation integrates the velocity
    add("travel", (has("position") ? c.position_gain : c.velocity_gain) *
                      (whole ? c.stroke_m : std::max(0.0, end_s - 1) * c.speed_m_s));
    if (whole) add("return_error", 1e-5);
  }
  add("drive_saturation", w.drive_saturation);
  if (w.temperature_deviation_K != 0.0) add("fluid_temperature", 277.15 + w.temperature_deviation_K);
  const bool pressures = has("pressure_a") && has("pressure_b");
  if (pressures && whole) {
    const double b = c.pressure_a_bias;
    add("running_pressure_out", out.dp + b);
    add("running_pressure_back", back.dp + b);
    add("friction_pressure", (back.dp - out.dp) / 2);
    add("breakaway_pressure", c.friction_N / kArea + c.breakaway_extra_Pa);
    add("hold_pressure", hold.dp + b);
    add("hold_decay", 1e3);
    if (has("flow")) add("leakage_resistance", (hold.dp + b) / (c.flow_gain * hold.q + c.flow_bias));
  }
  if (has("motor_current") && whole) add("peak_current", c.current_gain * back.i);
  return test;
}

/// The same by the virtual bench.
inline Test make_up(const Condition& condition, const Circumstances& circumstances) {
  Test test = make(condition, circumstances);
  for (Header* const header : {&test.window.header, &test.features.header}) {
    header->pst_id += kEndOfMadeUpId;
    header->message_id += kEndOfMadeUpId;
  }
  return test;
}

}  // namespace sealwatch::synthetic

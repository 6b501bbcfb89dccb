// A partial stroke test with known answers, for tests of signal processing and of the layers that use it.
//
// The piston runs x_0 -> x_0 + stroke -> x_0 with raised-cosine changes of speed. Massless piston and rigid circuit:
//   p_A - p_B = (phi + f_C v) / A_C,   p_B constant,   q = A_C v + (p_A - p_B)/R_CL + (V_A/beta) dp_A/dt
//   omega = A_C v / alpha_P,   u = 0.2 omega,   i = 1 + v / speed
// Sensors: delay by `late_s`, sign by `sign`, Gaussian noise of docs/model.md times `noise`.
#pragma once

#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "sealwatch/core/time_series.hpp"

namespace sealwatch::test {

struct SyntheticPst {
  double rate_Hz = 200.0;
  double noise = 1.0;  ///< times the sensors' noise of docs/model.md
  unsigned seed = 1;
  double duration_s = 31.0;
  double start_m = 0.060, stroke_m = -0.016, speed_m_s = 1.33e-3, ramp_s = 0.6, rest_s = 1.0, hold_s = 3.0;
  double load_N = 6e4, friction_N_s_m = 2e6, area_m2 = 5.89e-3, resistance_Pa_s_m3 = 2.6e13;
  double dead_volume_m3 = 5e-5, bulk_modulus_Pa = 1.2e9, displacement_m3_rad = 3.98e-8, pressure_b_Pa = 1.5e6;
  std::map<std::string, double> late_s = {};
  std::map<std::string, double> sign = {};

  [[nodiscard]] double stroke_time_s() const { return std::abs(stroke_m) / speed_m_s + ramp_s; }
  [[nodiscard]] double out_begin_s() const { return rest_s; }
  [[nodiscard]] double hold_begin_s() const { return rest_s + stroke_time_s(); }
  [[nodiscard]] double back_begin_s() const { return hold_begin_s() + hold_s; }
  [[nodiscard]] double back_end_s() const { return back_begin_s() + stroke_time_s(); }

  /// Share of one stroke's way at `t` after its begin: raised-cosine ramps of speed, constant speed between.
  [[nodiscard]] double way(double t) const {
    const double whole = stroke_time_s();
    const auto ramp = [this](double s) {  // integral of (1 - cos(pi s / ramp)) / 2
      return 0.5 * (s - ramp_s / std::numbers::pi * std::sin(std::numbers::pi * s / ramp_s));
    };
    if (t <= 0.0) return 0.0;
    if (t >= whole) return 1.0;
    const double full = whole - ramp_s;
    if (t < ramp_s) return ramp(t) / full;
    if (t <= whole - ramp_s) return (t - 0.5 * ramp_s) / full;
    return 1.0 - ramp(whole - t) / full;
  }
  [[nodiscard]] double position(double t) const {
    return start_m + stroke_m * (way(t - out_begin_s()) - way(t - back_begin_s()));
  }
  [[nodiscard]] double velocity(double t) const { return (position(t + 1e-4) - position(t - 1e-4)) / 2e-4; }
  [[nodiscard]] double differential_pressure(double t) const {
    return (load_N + friction_N_s_m * velocity(t)) / area_m2;
  }
  [[nodiscard]] double leakage(double t) const { return differential_pressure(t) / resistance_Pa_s_m3; }
  [[nodiscard]] double flow(double t) const {
    const double rate = (differential_pressure(t + 1e-4) - differential_pressure(t - 1e-4)) / 2e-4;
    return area_m2 * velocity(t) + leakage(t) + (dead_volume_m3 + area_m2 * position(t)) / bulk_modulus_Pa * rate;
  }
  [[nodiscard]] double shaft_speed(double t) const { return area_m2 * velocity(t) / displacement_m3_rad; }

  [[nodiscard]] TimeSeries record() const {
    struct Channel {
      const char* name;
      const char* unit;
      double noise_std;
      std::function<double(double)> value;
    };
    const std::vector<Channel> channels = {
        {"motor_voltage", "V", 0.0, [this](double t) { return 0.2 * shaft_speed(t); }},
        {"motor_current", "A", 0.02, [this](double t) { return 1.0 + velocity(t) / speed_m_s; }},
        {"shaft_speed", "rad/s", 0.5, [this](double t) { return shaft_speed(t); }},
        {"pressure_a", "Pa", 1e4, [this](double t) { return pressure_b_Pa + differential_pressure(t); }},
        {"pressure_b", "Pa", 1e4, [this](double) { return pressure_b_Pa; }},
        {"flow", "m3/s", 4e-8, [this](double t) { return flow(t); }},
        {"position", "m", 5e-6, [this](double t) { return position(t); }},
        {"velocity", "m/s", 1e-5, [this](double t) { return velocity(t); }},
    };
    std::mt19937 generator(seed);
    std::normal_distribution<double> normal;
    const auto count = static_cast<std::size_t>(duration_s * rate_Hz) + 1;
    TimeSeries samples;
    for (std::size_t i = 0; i < count; ++i) samples.time_s.push_back(static_cast<double>(i) / rate_Hz);
    for (const Channel& channel : channels) {
      const double delay = late_s.contains(channel.name) ? late_s.at(channel.name) : 0.0;
      const double factor = sign.contains(channel.name) ? sign.at(channel.name) : 1.0;
      Series series{channel.name, channel.unit, noise * channel.noise_std, {}};
      for (const double t : samples.time_s)
        series.values.push_back(factor * channel.value(t - delay) + noise * channel.noise_std * normal(generator));
      samples.channels.push_back(std::move(series));
    }
    return samples;
  }
};

/// The same without some channels.
inline TimeSeries only(const TimeSeries& samples, const std::vector<std::string>& names) {
  TimeSeries result{.time_s = samples.time_s, .channels = {}, .input_hold = samples.input_hold};
  for (const std::string& name : names) result.channels.push_back(*samples.find(name));
  return result;
}

}  // namespace sealwatch::test

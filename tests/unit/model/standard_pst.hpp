// The voltage of a standard partial stroke test of the nominal `eha`: rest 1 s, 16 mm towards closed at 1.33 mm/s, hold
// 3 s, back, hold 3 s, 31 s in all. Feed-forward from the steady balances, so that no solver takes part in making it:
//
//   omega = (A_C v + dp / R_CL + dp / R_PL) / alpha_P,  dp = (phi + f_C v) / A_C
//   u = R_M i + Omega_M omega,  i = ((f_M + d_P) omega + alpha_P dp) / T_M
#pragma once

#include <cmath>

#include "tests/unit/model/recording_for_tests.hpp"

namespace sealwatch {

inline double standard_pst_speed(double t) {
  constexpr double kSpeed_m_s = 1.33e-3, kCorner_s = 0.02;
  const auto on = [](double s) { return 0.5 * (1.0 + std::tanh(s / kCorner_s)); };
  return kSpeed_m_s * (-(on(t - 1.0) - on(t - 13.03)) + (on(t - 16.03) - on(t - 28.06)));
}

inline TimeSeries standard_pst(const AssetConfig& asset, double rate_Hz = 200.0, double duration_s = 31.0) {
  const auto p = [&](const char* name) { return asset.parameter(name); };
  TimeSeries samples;
  Series voltage{"motor_voltage", "V", 0.0, {}};
  const auto count = static_cast<std::size_t>(std::lround(duration_s * rate_Hz));
  for (std::size_t k = 0; k < count; ++k) {
    const double t = static_cast<double>(k) / rate_Hz;
    const double v = standard_pst_speed(t);
    const double dp = (p("phi") + p("f_C") * v) / p("A_C");
    const double omega = (p("A_C") * v + dp / p("R_CL") + dp / p("R_PL")) / p("alpha_P");
    const double i = ((p("f_M") + p("d_P")) * omega + p("alpha_P") * dp) / p("T_M");
    samples.time_s.push_back(t);
    voltage.values.push_back(std::round(1e5 * (p("R_M") * i + p("Omega_M") * omega)) * 1e-5);
  }
  samples.channels.push_back(std::move(voltage));
  const double dp = p("phi") / p("A_C");
  const auto constant = [&](const char* name, const char* unit, double value) {
    samples.channels.push_back({name, unit, 0.0, std::vector<double>(count, value)});
  };
  constant("motor_current", "A", 0.0);
  constant("shaft_speed", "rad/s", 0.0);
  constant("pressure_a", "Pa", p("p_0") + dp);
  constant("pressure_b", "Pa", p("p_0"));
  constant("flow", "m3/s", 0.0);
  constant("position", "m", 0.060);
  constant("velocity", "m/s", 0.0);
  return samples;
}

}  // namespace sealwatch

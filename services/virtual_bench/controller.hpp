// Cascaded controller of the partial stroke test: position, then velocity, continuous in time.
//
//   r_v   = k_pos (r_x - x), limited to +-1.6 times the reference's ramp speed         velocity set-point [m/s]
//   u*    = Omega_M A_C r_v / alpha_P + k_vel (r_v - v) + U                              voltage asked for [V]
//   u     = u*, limited to +-60 V                                                        driver voltage command [V]
//   dU/dt = k_int (r_v - v) + (u - u*) / T_w                                             integral part [V]
//
// The last term is the anti-windup (back-calculation): at the limit the integral follows it within T_w.
#pragma once

#include <algorithm>

namespace sealwatch::bench {

struct ControllerSetting {
  double k_pos_1_s = 3.0;
  double k_vel_V_s_m = 4000.0;
  double k_int_V_m = 8000.0;
  double speed_margin = 1.6;  ///< velocity set-point over ramp speed
  double voltage_limit_V = 60.0;
  double anti_windup_time_s = 0.1;  ///< T_w
};

struct ControllerOutput {
  double voltage_V = 0.0;          ///< u
  double integral_rate_V_s = 0.0;  ///< dU/dt
};

struct CascadeController {
  ControllerSetting setting = {};
  double feed_forward_V_s_m = 0.0;  ///< Omega_M A_C / alpha_P: the pump's voltage for a piston speed
  double ramp_speed_m_s = 0.0;

  [[nodiscard]] ControllerOutput operator()(double reference_m, double x_m, double v_m_s, double integral_V) const {
    const double fastest = setting.speed_margin * ramp_speed_m_s;
    const double r_v = std::clamp(setting.k_pos_1_s * (reference_m - x_m), -fastest, fastest);
    const double asked = feed_forward_V_s_m * r_v + setting.k_vel_V_s_m * (r_v - v_m_s) + integral_V;
    const double voltage = std::clamp(asked, -setting.voltage_limit_V, setting.voltage_limit_V);
    return {voltage, setting.k_int_V_m * (r_v - v_m_s) + (voltage - asked) / setting.anti_windup_time_s};
  }
};

}  // namespace sealwatch::bench

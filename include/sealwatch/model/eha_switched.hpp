// Plant `eha_switched`: bench with a DC motor, a gear pump that turns one way, directional valves, a single-rod
// cylinder and an accumulator as tank. Valve state s = +1 joins pump to chamber A and chamber B to the accumulator (the
// piston extends, +x), -1 the other way round, 0 blocks all ports. Pressures are above ambient.
//
//   winding      L_M di/dt = U_supply |duty| - R_M i - Omega_M omega                           i      winding current
//   [A] shaft        J_M domega/dt = Omega_M i - f_M omega - alpha_P dp - (T_0 + k_T |dp|) tanh(omega/omega_s)   omega
//   [rad/s]
//                dtheta/dt = omega,  dp = p_P - p_T                                            theta  shaft angle [rad]
//   supply       (V_P/b(p_P)) dp_P/dt = alpha_P omega - dp/R_PL - q_P                          p_P    supply line [Pa]
//   chamber_a    (V_A/b(p_A)) dp_A/dt = q_A - A_A v - q_CL,  V_A = V_0 + V_pipe + A_A x        p_A    chamber A, piston
//   side [Pa] chamber_b    (V_B/b(p_B)) dp_B/dt = q_B + A_B v + q_CL,  V_B = V_0 + V_pipe + A_B (x_C - x)    p_B
//   chamber B, rod side [Pa] accumulator  (C_T + V_P/b(p_T)) dp_T/dt = q_T - alpha_P omega + dp/R_PL p_T    accumulator
//   [Pa] piston       m_C dv/dt = A_A p_A - A_B p_B - f_C v - F_load(v) - F_stop,  dx/dt = v        v, x   [m/s], [m]
//
// q_P flows from the supply into the joined chamber, q_T from the other one into the accumulator, each through an
// orifice and laminar pipes in series; b is the bulk modulus of oil with trapped air; C_T the gas compliance while oil
// is in the accumulator; the load phi (1 + Phi) opposes extension and standstill and vanishes in retraction (a relief
// valve makes it).
#pragma once

#include <array>
#include <numbers>
#include <string_view>

#include "sealwatch/core/fields.hpp"
#include "sealwatch/model/laws.hpp"

namespace sealwatch {

template <class P>
struct EhaSwitchedParameters {
  P U_supply, R_M, L_M, Omega_M, J_M, f_M, T_0, k_T, alpha_P, R_PL, c_D, a_V, rho, nu, beta, air_fraction, p_ambient,
      d_pipe, l_supply, l_chamber, V_accumulator, p_preload, A_A, A_B, V_0, R_CL, m_C, f_C, phi, x_C, k_cushion,
      d_cushion;
  P load_factor;  ///< Phi of the recording: not in the table of parameters
  SEALWATCH_FIELDS(EhaSwitchedParameters, U_supply, R_M, L_M, Omega_M, J_M, f_M, T_0, k_T, alpha_P, R_PL, c_D, a_V, rho,
                   nu, beta, air_fraction, p_ambient, d_pipe, l_supply, l_chamber, V_accumulator, p_preload, A_A, A_B,
                   V_0, R_CL, m_C, f_C, phi, x_C, k_cushion, d_cushion, load_factor)
};

struct EhaSwitched {
  static constexpr int kStates = 9;
  template <class P>
  using Parameters = EhaSwitchedParameters<P>;
  template <class S>
  using State = std::array<S, kStates>;  ///< i, omega, theta, p_P, p_A, p_B, p_T, v, x
  enum Index { kI, kOmega, kTheta, kPP, kPA, kPB, kPT, kV, kX };
  struct Input {
    double duty = 0.0;
    double valve_state = 0.0;
  };

  static constexpr double kFrictionSpeed_rad_s = 1.0;  ///< width of the reversal of the pump's friction torque
  static constexpr double kPressureWidth_Pa = 1e4;     ///< width of the corners of pressure laws
  static constexpr double kLoadSpeed_m_s = 1e-3;       ///< speed of retraction at which the load is half gone
  static constexpr double kPolytropicExponent = 1.4;   ///< of the accumulator's gas and of the trapped air

  /// Laminar resistance of a pipe: 128 nu rho l / (pi d^4). [Pa s/m3]
  template <class P>
  [[nodiscard]] static auto pipe_resistance(const P& length, const EhaSwitchedParameters<P>& p) {
    const auto d2 = p.d_pipe * p.d_pipe;
    return 128.0 * p.nu * p.rho * length / (std::numbers::pi * d2 * d2);
  }
  template <class P>
  [[nodiscard]] static auto pipe_volume(const P& length, const EhaSwitchedParameters<P>& p) {
    return 0.25 * std::numbers::pi * p.d_pipe * p.d_pipe * length;
  }

  /// Valve and pipes in series: D = R q + q |q| / K^2, K = c_D a_V sqrt(2 / rho), solved for q. [m3/s]
  template <class D, class P>
  [[nodiscard]] static auto line_flow(const D& drop, const EhaSwitchedParameters<P>& p) {
    using std::abs;
    using std::sqrt;
    const auto resistance = pipe_resistance(p.l_supply, p) + pipe_resistance(p.l_chamber, p);
    const auto K = p.c_D * p.a_V * sqrt(2.0 / p.rho);
    return 2.0 * drop / (resistance + sqrt(resistance * resistance + 4.0 * abs(drop) / (K * K)));
  }

  /// Absolute pressure, kept positive: below ambient the oil cavitates and its pressure hardly falls further. [Pa]
  template <class S, class P>
  [[nodiscard]] static auto absolute_pressure(const S& pressure, const EhaSwitchedParameters<P>& p) {
    return laws::smooth_positive(pressure + p.p_ambient, kPressureWidth_Pa) + 1e3;
  }

  /// Bulk modulus of oil with a share of trapped air (polytropic). [Pa]
  template <class S, class P>
  [[nodiscard]] static auto bulk_modulus(const S& pressure, const EhaSwitchedParameters<P>& p) {
    using std::pow;
    const auto absolute = absolute_pressure(pressure, p);
    const auto air = p.air_fraction * pow(p.p_ambient / absolute, 1.0 / kPolytropicExponent);
    return p.beta * (1.0 + air) / (1.0 + air * p.beta / (kPolytropicExponent * absolute));
  }

  /// Compliance of the gas in the accumulator, dV/dp = V_gas / (n p), while there is oil in it. [m3/Pa]
  template <class S, class P>
  [[nodiscard]] static auto gas_compliance(const S& p_T, const EhaSwitchedParameters<P>& p) {
    using std::pow;
    const auto absolute = absolute_pressure(p_T, p);
    const auto gas = p.V_accumulator * pow((p.p_preload + p.p_ambient) / absolute, 1.0 / kPolytropicExponent);
    return laws::smooth_step((p_T - p.p_preload) / kPressureWidth_Pa) * gas / (kPolytropicExponent * absolute);
  }

  template <class S, class P>
  [[nodiscard]] static auto load_force(const S& v, const EhaSwitchedParameters<P>& p) {
    return p.phi * (1.0 + p.load_factor) * laws::smooth_step((v + kLoadSpeed_m_s) / (0.5 * kLoadSpeed_m_s));
  }

  /// Force of both end stops, in the direction of -x. [N]
  template <class S, class P>
  [[nodiscard]] static auto stop_force(const S& x, const S& v, const EhaSwitchedParameters<P>& p) {
    return laws::end_stop_force(x - p.x_C, v, p.k_cushion, p.d_cushion) -
           laws::end_stop_force(-x, -v, p.k_cushion, p.d_cushion);
  }

  template <class S, class P>
  [[nodiscard]] static auto derivatives(const State<S>& y, const Input& input, const EhaSwitchedParameters<P>& p) {
    using std::abs;
    using std::tanh;
    using R = decltype(y[0] * p.R_M);
    const auto& [i, omega, theta, p_P, p_A, p_B, p_T, v, x] = y;
    const bool extend = input.valve_state > 0.5, retract = input.valve_state < -0.5;
    const R q_PA = extend ? line_flow(p_P - p_A, p) : R(0.0);
    const R q_PB = retract ? line_flow(p_P - p_B, p) : R(0.0);
    const R q_AT = retract ? line_flow(p_A - p_T, p) : R(0.0);
    const R q_BT = extend ? line_flow(p_B - p_T, p) : R(0.0);
    const auto dp = p_P - p_T;
    const auto friction =
        (p.T_0 + p.k_T * laws::smooth_abs(dp, kPressureWidth_Pa)) * tanh(omega / kFrictionSpeed_rad_s);
    const auto q_pump = p.alpha_P * omega - dp / p.R_PL;
    const auto q_CL = laws::laminar_flow(p_A - p_B, p.R_CL);
    const auto V_P = pipe_volume(p.l_supply, p);
    const auto V_chamber = p.V_0 + pipe_volume(p.l_chamber, p);
    const auto V_A = V_chamber + p.A_A * x;
    const auto V_B = V_chamber + p.A_B * (p.x_C - x);
    return State<R>{
        (p.U_supply * std::abs(input.duty) - p.R_M * i - p.Omega_M * omega) / p.L_M,
        (p.Omega_M * i - p.f_M * omega - p.alpha_P * dp - friction) / p.J_M,
        R(omega),
        bulk_modulus(p_P, p) / V_P * (q_pump - q_PA - q_PB),
        bulk_modulus(p_A, p) / V_A * (q_PA - q_AT - p.A_A * v - q_CL),
        bulk_modulus(p_B, p) / V_B * (q_PB - q_BT + p.A_B * v + q_CL),
        (q_AT + q_BT - q_pump) / (gas_compliance(p_T, p) + V_P / bulk_modulus(p_T, p)),
        (p.A_A * p_A - p.A_B * p_B - p.f_C * v - load_force(v, p) - stop_force(x, v, p)) / p.m_C,
        R(v),
    };
  }
};

}  // namespace sealwatch

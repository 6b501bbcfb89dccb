// Plant `eha_switched`: bench with a DC motor, a gear pump that turns one way, directional valves, a single-rod
// cylinder and an accumulator as tank. Valve state s = +1 joins pump to chamber A and chamber B to the accumulator (the
// piston extends, +x), -1 the other way round, 0 blocks all ports. Pressures are above ambient.
//
//   winding      L_M di/dt = U_supply |duty| - R_M i - Omega_M omega
//   shaft        J_M domega/dt = Omega_M i - f_M omega - alpha_P dp - (T_0 + k_T |dp|) tanh(omega/omega_s)
//                dtheta/dt = omega,  dp = p_P - p_T
//   supply       (V_P/b(p_P)) dp_P/dt = alpha_P omega - dp/R_PL - q_P
//   chamber_a    (V_A/b(p_A)) dp_A/dt = q_A - A_A v - q_CL,  V_A = V_0 + V_pipe + A_A x
//   chamber_b    (V_B/b(p_B)) dp_B/dt = q_B + A_B v + q_CL,  V_B = V_0 + V_pipe + A_B (x_C - x)
//   accumulator  (C_T + V_P/b(p_T)) dp_T/dt = q_T - alpha_P omega + dp/R_PL
//   piston       m_C dv/dt = A_A p_A - A_B p_B - f_C v - F_load(v) - F_stop,  dx/dt = v
//
// i: winding current [A]; omega, theta: speed and angle of the shaft [rad/s], [rad]; p_P, p_A, p_B, p_T: pressures of
// the supply line, of chamber A (piston side), of chamber B (rod side) and of the accumulator [Pa]; v, x: speed and
// position of the piston [m/s], [m].
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
#include "sealwatch/model/eha.hpp"
#include "sealwatch/model/laws.hpp"
#include "sealwatch/model/no_extra.hpp"
#include "sealwatch/model/sites.hpp"

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

  /// Where laws of the catalogue may act, in the order of `extra`. Valve 1 is the line to chamber A, valve 2 to B.
  static constexpr std::array kSites = {Site{"driver", SiteKind::voltage_command, Feeds::motor},
                                        Site{"winding", SiteKind::winding_voltage},
                                        Site{"shaft", SiteKind::shaft_torque},
                                        Site{"pump", SiteKind::pump_slip},
                                        Site{"valve_1", SiteKind::line_drop},
                                        Site{"valve_2", SiteKind::line_drop},
                                        Site{"chamber_a", SiteKind::outflow},
                                        Site{"chamber_b", SiteKind::outflow},
                                        Site{"chamber_a", SiteKind::compliance},
                                        Site{"chamber_b", SiteKind::compliance},
                                        Site{"piston_seal", SiteKind::seal_leakage},
                                        Site{"piston", SiteKind::piston_force},
                                        Site{"fluid", SiteKind::inverse_modulus},
                                        Site{"fluid", SiteKind::inverse_modulus},
                                        Site{"fluid", SiteKind::inverse_modulus}};
  enum SiteIndex {
    kDriverVoltage,
    kWindingVoltage,
    kShaftTorque,
    kPumpSlip,
    kDrop1,
    kDrop2,
    kOutflowA,
    kOutflowB,
    kComplianceA,
    kComplianceB,
    kSealLeakage,
    kPistonForce,
    kModulusP,
    kModulusA,
    kModulusB
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

  /// Flow into chamber A or B through its joined line. `loss` is lost before the chamber. [m3/s]
  template <class S, class P, class E = None>
  [[nodiscard]] static auto chamber_flow(int direction, const S& chamber, const State<S>& y,
                                         const EhaSwitchedParameters<P>& p, const E& loss = {}) {
    using R = decltype(line_flow(y[kPP] - chamber - loss, p));
    if (direction > 0) return R(line_flow(y[kPP] - chamber - loss, p));
    if (direction < 0) return R(line_flow(y[kPT] - chamber - loss, p));
    return R(0.0);
  }

  /// +1, -1 or 0: which way the valves are.
  [[nodiscard]] static int direction(const Input& input) {
    return input.valve_state > 0.5 ? 1 : input.valve_state < -0.5 ? -1 : 0;
  }

  /// What laws see at a site (model/physics.hpp).
  template <class R, class S, class P, class Extra>
  [[nodiscard]] static std::array<R, kSiteSignals> signals(std::size_t site, const State<S>& y, const Input& input,
                                                           const EhaSwitchedParameters<P>& p, const Extra& extra) {
    const auto& [i, omega, theta, p_P, p_A, p_B, p_T, v, x] = y;
    const R none(0.0);
    switch (site) {
      case kDriverVoltage:
        return {R(i), R(p.U_supply * std::abs(input.duty)), none, none};
      case kWindingVoltage:
        return {R(i), R(omega), none, none};
      case kShaftTorque:
        return {R(omega), R(p_P - p_T), R(i), none};
      case kPumpSlip:
        return {R(p_P - p_T), R(omega), none, none};
      case kDrop1:
        return {R(chamber_flow(direction(input), p_A, y, p, extra[kDrop1])), R(p_P - p_A), none, none};
      case kDrop2:
        return {R(chamber_flow(-direction(input), p_B, y, p, extra[kDrop2])), R(p_P - p_B), none, none};
      case kOutflowA:
        return {R(p_A), none, none, none};
      case kOutflowB:
        return {R(p_B), none, none, none};
      case kSealLeakage:
        return {R(p_A - p_B), R(v), R(x), none};
      case kPistonForce:
        return {R(v), R(x), R(p_A), R(p_B)};
      case kModulusP:
        return {R(absolute_pressure(p_P, p)), none, none, none};
      case kComplianceA:
      case kModulusA:
        return {R(absolute_pressure(p_A, p)), none, none, none};
      default:
        return {R(absolute_pressure(p_B, p)), none, none, none};
    }
  }

  template <class S, class P, class Extra = NoExtra>
  [[nodiscard]] static auto derivatives(const State<S>& y, const Input& input, const EhaSwitchedParameters<P>& p,
                                        const Extra& extra = {}) {
    using std::abs;
    using std::tanh;
    using R = decltype(y[0] * p.R_M + extra[0]);
    const auto& [i, omega, theta, p_P, p_A, p_B, p_T, v, x] = y;
    const int way = direction(input);
    const R q_A = chamber_flow(way, p_A, y, p, extra[kDrop1]);
    const R q_B = chamber_flow(-way, p_B, y, p, extra[kDrop2]);
    const R q_supply = way > 0 ? q_A : q_B;    // both are 0 while the valves block
    const R q_return = way > 0 ? -q_B : -q_A;  // into the accumulator
    const auto dp = p_P - p_T;
    const auto friction =
        (p.T_0 + p.k_T * laws::smooth_abs(dp, kPressureWidth_Pa)) * tanh(omega / kFrictionSpeed_rad_s);
    const auto q_pump = p.alpha_P * omega - dp / p.R_PL - extra[kPumpSlip];
    const auto q_CL = laws::laminar_flow(p_A - p_B, p.R_CL) + extra[kSealLeakage];
    const auto V_P = pipe_volume(p.l_supply, p);
    const auto V_chamber = p.V_0 + pipe_volume(p.l_chamber, p);
    const auto V_A = V_chamber + p.A_A * x;
    const auto V_B = V_chamber + p.A_B * (p.x_C - x);
    const auto voltage_losses = p.R_M * i + p.Omega_M * omega + extra[kDriverVoltage] + extra[kWindingVoltage];
    const auto force_losses = p.f_C * v + load_force(v, p) + stop_force(x, v, p) + extra[kPistonForce];
    return State<R>{
        R((p.U_supply * std::abs(input.duty) - voltage_losses) / p.L_M),
        R((p.Omega_M * i - p.f_M * omega - p.alpha_P * dp - friction - extra[kShaftTorque]) / p.J_M),
        R(omega),
        R(Eha::stiffness(V_P, bulk_modulus(p_P, p), extra[kModulusP]) * (q_pump - q_supply)),
        R(Eha::stiffness(V_A, bulk_modulus(p_A, p), extra[kModulusA], extra[kComplianceA]) *
          (q_A - p.A_A * v - q_CL - extra[kOutflowA])),
        R(Eha::stiffness(V_B, bulk_modulus(p_B, p), extra[kModulusB], extra[kComplianceB]) *
          (q_B + p.A_B * v + q_CL - extra[kOutflowB])),
        R((q_return - q_pump) / (gas_compliance(p_T, p) + V_P / bulk_modulus(p_T, p))),
        R((p.A_A * p_A - p.A_B * p_B - force_losses) / p.m_C),
        R(v),
    };
  }
};

}  // namespace sealwatch

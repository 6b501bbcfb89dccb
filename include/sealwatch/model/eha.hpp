// Plant `eha`: closed-circuit electro-hydrostatic actuator. Motor, fixed-displacement pump, one pilot-operated check
// valve per side, double-acting cylinder. Positive u turns the pump so that oil flows into chamber A, the piston moves
// in +x; the load opposes +x when positive.
//
//   driver     dz/dt = (u - z) / (R_M C_M)                                         z      filtered driver voltage [V]
//   winding    L_M di/dt = z - R_M i - Omega_M omega                               i      winding current [A]
//   shaft      J_M domega/dt = T_M i - (f_M + d_P) omega - alpha_P (p_1 - p_2)     omega  shaft speed [rad/s]
//   port_1     (V_P/beta) dp_1/dt =  alpha_P omega - q_PL - q_V1 + q_C1            p_1, p_2  pump port pressures [Pa]
//   port_2     (V_P/beta) dp_2/dt = -alpha_P omega + q_PL - q_V2 + q_C2
//   chamber_a  (V_A/beta) dp_A/dt = q_V1 - A_A v - q_CL,  V_A = V_0 + A_A x        p_A, p_B  chamber pressures [Pa]
//   chamber_b  (V_B/beta) dp_B/dt = q_V2 + A_B v + q_CL,  V_B = V_0 + A_B (x_C - x)
//   piston     m_C dv/dt = A_A p_A - A_B p_B - f_C v - phi (1 + Phi) - F_cushion   v      piston velocity [m/s]
//              dx/dt = v                                                          x      piston position [m]
//
// with A_A = A_C, A_B = area_ratio A_C; q_PL = (p_1 - p_2)/R_PL; q_CL = (p_A - p_B)/R_CL; q_Ck make-up flow from the
// reservoir at p_0; q_Vk through check valve k, opened by its own pressure drop or by the other port's pilot pressure.
// Source: docs/model.md, where every symbol has its unit, default and bounds.
#pragma once

#include <array>
#include <string_view>

#include "sealwatch/core/fields.hpp"
#include "sealwatch/model/laws.hpp"
#include "sealwatch/model/no_extra.hpp"
#include "sealwatch/model/sites.hpp"

namespace sealwatch {

template <class P>
struct EhaParameters {
  P R_M, C_M, L_M, Omega_M, T_M, J_M, f_M, d_P, alpha_P, R_PL, V_P, c_D, a_V, k_V, g_V, p_crack, r_pilot, eps_V, rho,
      beta, p_0, K_MU, s_MU, p_ambient, A_C, area_ratio, V_0, R_CL, m_C, f_C, phi, x_C, x_cushion, k_cushion, d_cushion;
  P load_factor;  ///< Phi of the recording: not in the table of parameters
  SEALWATCH_FIELDS(EhaParameters, R_M, C_M, L_M, Omega_M, T_M, J_M, f_M, d_P, alpha_P, R_PL, V_P, c_D, a_V, k_V, g_V,
                   p_crack, r_pilot, eps_V, rho, beta, p_0, K_MU, s_MU, p_ambient, A_C, area_ratio, V_0, R_CL, m_C, f_C,
                   phi, x_C, x_cushion, k_cushion, d_cushion, load_factor)
};

struct Eha {
  static constexpr int kStates = 9;
  template <class P>
  using Parameters = EhaParameters<P>;
  template <class S>
  using State = std::array<S, kStates>;  ///< z, i, omega, p_1, p_2, p_A, p_B, v, x
  enum Index { kZ, kI, kOmega, kP1, kP2, kPA, kPB, kV, kX };
  struct Input {
    double voltage_V = 0.0;
    double voltage_rate_V_s = 0.0;
  };

  /// Where laws of the catalogue may act, in the order of `extra`.
  static constexpr std::array kSites = {Site{"driver", SiteKind::voltage_command, Feeds::motor},
                                        Site{"winding", SiteKind::winding_voltage},
                                        Site{"shaft", SiteKind::shaft_torque},
                                        Site{"pump", SiteKind::pump_slip},
                                        Site{"valve_1", SiteKind::line_drop},
                                        Site{"valve_2", SiteKind::line_drop},
                                        Site{"valve_1", SiteKind::valve_crack},
                                        Site{"valve_2", SiteKind::valve_crack},
                                        Site{"chamber_a", SiteKind::outflow},
                                        Site{"chamber_b", SiteKind::outflow},
                                        Site{"chamber_a", SiteKind::compliance},
                                        Site{"chamber_b", SiteKind::compliance},
                                        Site{"piston_seal", SiteKind::seal_leakage},
                                        Site{"piston", SiteKind::piston_force},
                                        Site{"fluid", SiteKind::inverse_modulus},
                                        Site{"fluid", SiteKind::inverse_modulus},
                                        Site{"fluid", SiteKind::inverse_modulus},
                                        Site{"fluid", SiteKind::inverse_modulus},
                                        Site{"fluid", SiteKind::viscosity}};
  enum SiteIndex {
    kDriverVoltage,
    kWindingVoltage,
    kShaftTorque,
    kPumpSlip,
    kDrop1,
    kDrop2,
    kCrack1,
    kCrack2,
    kOutflowA,
    kOutflowB,
    kComplianceA,
    kComplianceB,
    kSealLeakage,
    kPistonForce,
    kModulus1,
    kModulus2,
    kModulusA,
    kModulusB,
    kViscosity
  };

  /// Check valve: opened forward by its drop, or by the pilot pressure of the other port. [m3/s] from port to chamber.
  /// `line_drop` is lost before the valve, `crack` lowers its cracking pressure. [Pa]
  template <class S, class P, class E = None>
  [[nodiscard]] static auto valve_flow(const S& port, const S& chamber, const S& other_port, const EhaParameters<P>& p,
                                       const E& line_drop = {}, const E& crack = {}) {
    const auto drop = port - chamber - line_drop;
    const auto forward = laws::smooth_step(p.k_V * (drop - p.p_crack + crack));
    const auto pilot = laws::smooth_step(p.g_V * (p.r_pilot * (other_port - p.p_0) - (chamber - p.p_0)));
    const bool by_forward = value_of(forward) >= value_of(pilot);
    return laws::orifice_flow(p.c_D, p.a_V * (by_forward ? forward : pilot), p.rho, drop, p.eps_V);
  }

  /// Force of both end cushions, in the direction of -x. [N]
  template <class S, class P>
  [[nodiscard]] static auto cushion_force(const S& x, const S& v, const EhaParameters<P>& p) {
    const auto low = laws::end_stop_force(p.x_cushion - x, -v, p.k_cushion, p.d_cushion);
    const auto high = laws::end_stop_force(x - (p.x_C - p.x_cushion), v, p.k_cushion, p.d_cushion);
    return high - low;
  }

  /// Pressure drop and flow of valve k = 1, 2: the signals of laws at its line and seat.
  template <class S, class P, class Extra>
  [[nodiscard]] static auto valve_signals(int valve, const State<S>& y, const EhaParameters<P>& p, const Extra& extra) {
    const bool first = valve == 1;
    const S &port = first ? y[kP1] : y[kP2], &chamber = first ? y[kPA] : y[kPB], &other = first ? y[kP2] : y[kP1];
    const auto &line_drop = extra[first ? kDrop1 : kDrop2], &crack = extra[first ? kCrack1 : kCrack2];
    return std::pair(port - chamber - line_drop, valve_flow(port, chamber, other, p, line_drop, crack));
  }

  /// What laws see at a site (model/physics.hpp), with what is added at others.
  template <class R, class S, class P, class Extra>
  [[nodiscard]] static std::array<R, kSiteSignals> signals(std::size_t site, const State<S>& y, const Input& input,
                                                           const EhaParameters<P>& p, const Extra& extra) {
    const auto& [z, i, omega, p_1, p_2, p_A, p_B, v, x] = y;
    switch (site) {
      case kDriverVoltage:
        return {R(i), R(input.voltage_V), R(input.voltage_rate_V_s), R(0.0)};
      case kWindingVoltage:
        return {R(i), R(omega), R(0.0), R(0.0)};
      case kShaftTorque:
        return {R(omega), R(p_1 - p_2), R(i), R(0.0)};
      case kPumpSlip:
        return {R(p_1 - p_2), R(omega), R(0.0), R(0.0)};
      case kDrop1:
      case kDrop2: {
        const auto [drop, flow] = valve_signals(site == kDrop1 ? 1 : 2, y, p, extra);
        return {R(flow), R(drop), R(0.0), R(0.0)};
      }
      case kCrack1:
      case kCrack2: {
        const auto [drop, flow] = valve_signals(site == kCrack1 ? 1 : 2, y, p, extra);
        return {R(drop), R(flow), R(0.0), R(0.0)};
      }
      case kOutflowA:
        return {R(p_A - p.p_0), R(0.0), R(0.0), R(0.0)};
      case kOutflowB:
        return {R(p_B - p.p_0), R(0.0), R(0.0), R(0.0)};
      case kComplianceA:
      case kModulusA:
        return {R(p_A + p.p_ambient), R(0.0), R(0.0), R(0.0)};
      case kComplianceB:
      case kModulusB:
        return {R(p_B + p.p_ambient), R(0.0), R(0.0), R(0.0)};
      case kModulus1:
        return {R(p_1 + p.p_ambient), R(0.0), R(0.0), R(0.0)};
      case kModulus2:
        return {R(p_2 + p.p_ambient), R(0.0), R(0.0), R(0.0)};
      case kSealLeakage:
        return {R(p_A - p_B), R(v), R(x), R(0.0)};
      case kPistonForce:
        return {R(v), R(x), R(p_A), R(p_B)};
      default:
        return {R(laws::smooth_abs(z * i, kPowerWidth_W)), R(0.0), R(0.0), R(0.0)};
    }
  }
  static constexpr double kPowerWidth_W = 0.1;  ///< width of the corner of the dissipated power

  /// beta / (V (1 + beta inverse_modulus) + beta compliance): pressure rise for oil pressed in. [Pa/m3]
  template <class V, class P>
  [[nodiscard]] static auto stiffness(const V& volume, const P& beta, None, None) {
    return beta / volume;
  }
  template <class V, class P, class E>
  [[nodiscard]] static auto stiffness(const V& volume, const P& beta, const E& inverse_modulus, const E& compliance) {
    return beta / (volume * (1.0 + beta * inverse_modulus) + beta * compliance);
  }
  template <class V, class P, class E>
  [[nodiscard]] static auto stiffness(const V& volume, const P& beta, const E& inverse_modulus) {
    return beta / (volume * (1.0 + beta * inverse_modulus));
  }
  template <class V, class P>
  [[nodiscard]] static auto stiffness(const V& volume, const P& beta, None) {
    return beta / volume;
  }

  template <class S, class P, class Extra = NoExtra>
  [[nodiscard]] static auto derivatives(const State<S>& y, const Input& input, const EhaParameters<P>& p,
                                        const Extra& extra = {}) {
    const auto& [z, i, omega, p_1, p_2, p_A, p_B, v, x] = y;
    const auto viscosity = 1.0 + extra[kViscosity];  // relative
    const auto q_PL = laws::laminar_flow(p_1 - p_2, p.R_PL * viscosity) + extra[kPumpSlip];
    const auto q_CL = laws::laminar_flow(p_A - p_B, p.R_CL * viscosity) + extra[kSealLeakage];
    const auto q_C1 = laws::make_up_flow(p.K_MU, p.p_0, p_1, p.s_MU);
    const auto q_C2 = laws::make_up_flow(p.K_MU, p.p_0, p_2, p.s_MU);
    const auto q_V1 = valve_flow(p_1, p_A, p_2, p, extra[kDrop1], extra[kCrack1]);
    const auto q_V2 = valve_flow(p_2, p_B, p_1, p, extra[kDrop2], extra[kCrack2]);
    const auto q_P = p.alpha_P * omega;
    const auto A_A = p.A_C;
    const auto A_B = p.area_ratio * p.A_C;
    const auto V_A = p.V_0 + A_A * x;
    const auto V_B = p.V_0 + A_B * (p.x_C - x);
    const auto load = p.phi * (1.0 + p.load_factor);
    const auto torque_losses = (p.f_M + p.d_P * viscosity) * omega + p.alpha_P * (p_1 - p_2) + extra[kShaftTorque];
    const auto force_losses = p.f_C * viscosity * v + load + cushion_force(x, v, p) + extra[kPistonForce];
    using R = decltype((z * p.R_M) + extra[kViscosity]);
    return State<R>{
        R((input.voltage_V - z - extra[kDriverVoltage]) / (p.R_M * p.C_M)),
        R((z - p.R_M * i - p.Omega_M * omega - extra[kWindingVoltage]) / p.L_M),
        R((p.T_M * i - torque_losses) / p.J_M),
        R(stiffness(p.V_P, p.beta, extra[kModulus1]) * (q_P - q_PL - q_V1 + q_C1)),
        R(stiffness(p.V_P, p.beta, extra[kModulus2]) * (q_PL - q_P - q_V2 + q_C2)),
        R(stiffness(V_A, p.beta, extra[kModulusA], extra[kComplianceA]) * (q_V1 - A_A * v - q_CL - extra[kOutflowA])),
        R(stiffness(V_B, p.beta, extra[kModulusB], extra[kComplianceB]) * (q_V2 + A_B * v + q_CL - extra[kOutflowB])),
        R((A_A * p_A - A_B * p_B - force_losses) / p.m_C),
        R(v),
    };
  }
};

}  // namespace sealwatch

// Plant `eha`: closed-circuit electro-hydrostatic actuator. Motor, fixed-displacement pump, one pilot-operated check
// valve per side, double-acting cylinder. Positive u turns the pump so that oil flows into chamber A, the piston moves
// in +x; the load opposes +x when positive.
//
//   driver     dz/dt = (u - z) / (R_M C_M)                                         z      voltage behind the driver
//   filter [V] winding    L_M di/dt = z - R_M i - Omega_M omega                               i      winding current
//   [A] shaft      J_M domega/dt = T_M i - (f_M + d_P) omega - alpha_P (p_1 - p_2)     omega  shaft speed [rad/s]
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
  };

  /// Check valve: opened forward by its drop, or by the pilot pressure of the other port. [m3/s] from port to chamber
  template <class S, class P>
  [[nodiscard]] static auto valve_flow(const S& port, const S& chamber, const S& other_port,
                                       const EhaParameters<P>& p) {
    const auto drop = port - chamber;
    const auto forward = laws::smooth_step(p.k_V * (drop - p.p_crack));
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

  template <class S, class P>
  [[nodiscard]] static auto derivatives(const State<S>& y, const Input& input, const EhaParameters<P>& p) {
    const auto& [z, i, omega, p_1, p_2, p_A, p_B, v, x] = y;
    const auto q_PL = laws::laminar_flow(p_1 - p_2, p.R_PL);
    const auto q_CL = laws::laminar_flow(p_A - p_B, p.R_CL);
    const auto q_C1 = laws::make_up_flow(p.K_MU, p.p_0, p_1, p.s_MU);
    const auto q_C2 = laws::make_up_flow(p.K_MU, p.p_0, p_2, p.s_MU);
    const auto q_V1 = valve_flow(p_1, p_A, p_2, p);
    const auto q_V2 = valve_flow(p_2, p_B, p_1, p);
    const auto q_P = p.alpha_P * omega;
    const auto A_A = p.A_C;
    const auto A_B = p.area_ratio * p.A_C;
    const auto V_A = p.V_0 + A_A * x;
    const auto V_B = p.V_0 + A_B * (p.x_C - x);
    const auto load = p.phi * (1.0 + p.load_factor);
    using R = decltype(z * p.R_M);
    return State<R>{
        (input.voltage_V - z) / (p.R_M * p.C_M),
        (z - p.R_M * i - p.Omega_M * omega) / p.L_M,
        (p.T_M * i - (p.f_M + p.d_P) * omega - p.alpha_P * (p_1 - p_2)) / p.J_M,
        (p.beta / p.V_P) * (q_P - q_PL - q_V1 + q_C1),
        (p.beta / p.V_P) * (q_PL - q_P - q_V2 + q_C2),
        (p.beta / V_A) * (q_V1 - A_A * v - q_CL),
        (p.beta / V_B) * (q_V2 + A_B * v + q_CL),
        (A_A * p_A - A_B * p_B - p.f_C * v - load - cushion_force(x, v, p)) / p.m_C,
        R(v),
    };
  }
};

}  // namespace sealwatch

// The cylinder circuit of plant `eha` alone, driven by the recorded flow into chamber A, for recordings without the
// motor's voltage (the source document's own set: flow, differential pressure, position, velocity).
//
//   chamber_a  (V_A/beta) dp_A/dt = q - A_A v - (p_A - p_B) / R_CL,  V_A = V_0 + A_A x      p_A  chamber A pressure
//   [Pa] piston     m_C dv/dt = A_A p_A - A_B p_B - f_C v - phi (1 + Phi) - F_cushion            v    piston velocity
//   [m/s]
//              dx/dt = v                                                                    x    piston position [m]
//
// q: recorded flow [m3/s]; p_B: recorded pressure of chamber B, or the reservoir's pressure p_0 where it is not
// recorded [Pa]. Symbols otherwise as in model/eha.hpp. The flow sensor's own lag is not undone: corners of a test come
// that much later.
#pragma once

#include "sealwatch/model/eha.hpp"

namespace sealwatch {

struct EhaCircuit {
  static constexpr int kStates = 3;
  template <class P>
  using Parameters = EhaParameters<P>;
  template <class S>
  using State = std::array<S, kStates>;  ///< p_A, v, x
  enum Index { kPA, kV, kX };
  struct Input {
    double flow_m3_s = 0.0;
    double pressure_b_Pa = 0.0;
  };

  template <class S, class P>
  [[nodiscard]] static auto derivatives(const State<S>& y, const Input& input, const EhaParameters<P>& p) {
    using R = decltype(y[0] * p.A_C);
    const auto& [p_A, v, x] = y;
    const double q = input.flow_m3_s, p_B = input.pressure_b_Pa;
    const auto A_A = p.A_C;
    const auto A_B = p.area_ratio * p.A_C;
    const auto q_CL = laws::laminar_flow(p_A - p_B, p.R_CL);
    const auto load = p.phi * (1.0 + p.load_factor);
    return State<R>{
        (p.beta / (p.V_0 + A_A * x)) * (q - A_A * v - q_CL),
        (A_A * p_A - A_B * p_B - p.f_C * v - load - Eha::cushion_force(x, v, p)) / p.m_C,
        R(v),
    };
  }
};

}  // namespace sealwatch

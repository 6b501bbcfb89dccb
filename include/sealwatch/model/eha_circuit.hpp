// The cylinder circuit of plant `eha` alone, driven by the recorded flow into chamber A and pressure of chamber B, for
// recordings without the motor's voltage.
//
//   chamber_a  (V_A/beta) dp_A/dt = q - A_A v - (p_A - p_B) / R_CL,  V_A = V_0 + A_A x
//   piston     m_C dv/dt = A_A p_A - A_B p_B - f_C v - phi (1 + Phi) - F_cushion,  dx/dt = v
//
// p_A: pressure of chamber A [Pa]; v, x: speed and position of the piston [m/s], [m]; q: recorded flow [m3/s]; p_B:
// recorded pressure of chamber B [Pa]. Symbols otherwise as in model/eha.hpp. Without p_B: model/eha_flow_driven.hpp.
#pragma once

#include "sealwatch/model/eha.hpp"
#include "sealwatch/model/no_extra.hpp"

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

  static constexpr std::array kSites = {
      Site{"chamber_a", SiteKind::outflow},        Site{"chamber_a", SiteKind::compliance},
      Site{"piston_seal", SiteKind::seal_leakage}, Site{"piston", SiteKind::piston_force},
      Site{"fluid", SiteKind::inverse_modulus},    Site{"fluid", SiteKind::viscosity}};
  enum SiteIndex { kOutflowA, kComplianceA, kSealLeakage, kPistonForce, kModulusA, kViscosity };

  /// What laws see at a site (model/physics.hpp). The power that warms the oil is the hydraulic one.
  template <class R, class S, class P, class Extra>
  [[nodiscard]] static std::array<R, kSiteSignals> signals(std::size_t site, const State<S>& y, const Input& input,
                                                           const EhaParameters<P>& p, const Extra&) {
    const auto& [p_A, v, x] = y;
    switch (site) {
      case kOutflowA:
        return {R(p_A - p.p_0), R(0.0), R(0.0), R(0.0)};
      case kSealLeakage:
        return {R(p_A - input.pressure_b_Pa), R(v), R(x), R(0.0)};
      case kPistonForce:
        return {R(v), R(x), R(p_A), R(input.pressure_b_Pa)};
      case kViscosity:
        return {R(laws::smooth_abs((p_A - input.pressure_b_Pa) * input.flow_m3_s, Eha::kPowerWidth_W)), R(0.0), R(0.0),
                R(0.0)};
      default:
        return {R(p_A + p.p_ambient), R(0.0), R(0.0), R(0.0)};
    }
  }

  template <class S, class P, class Extra = NoExtra>
  [[nodiscard]] static auto derivatives(const State<S>& y, const Input& input, const EhaParameters<P>& p,
                                        const Extra& extra = {}) {
    using R = decltype(y[0] * p.A_C + extra[0]);
    const auto& [p_A, v, x] = y;
    const double q = input.flow_m3_s, p_B = input.pressure_b_Pa;
    const auto A_A = p.A_C;
    const auto A_B = p.area_ratio * p.A_C;
    const auto viscosity = 1.0 + extra[kViscosity];  // relative
    const auto q_CL = laws::laminar_flow(p_A - p_B, p.R_CL * viscosity) + extra[kSealLeakage];
    const auto load = p.phi * (1.0 + p.load_factor);
    const auto force_losses = p.f_C * viscosity * v + load + Eha::cushion_force(x, v, p) + extra[kPistonForce];
    return State<R>{
        R(Eha::stiffness(p.V_0 + A_A * x, p.beta, extra[kModulusA], extra[kComplianceA]) *
          (q - A_A * v - q_CL - extra[kOutflowA])),
        R((A_A * p_A - A_B * p_B - force_losses) / p.m_C),
        R(v),
    };
  }
};

}  // namespace sealwatch

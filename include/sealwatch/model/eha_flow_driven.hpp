// The hydraulic part of plant `eha`, driven by the recorded flow into chamber A, for recordings with neither the motor's
// voltage nor the pressure of chamber B (the source document's own set: flow, differential pressure, position, velocity).
//
//   port_1     (V_P/beta) dp_1/dt =  q - q_V1                      the pump delivers what makes the flow past valve 1 q
//   port_2     (V_P/beta) dp_2/dt = -q_P - q_V2 + q_C2,   q_P = q + (V_P/beta) dp_1/dt - q_C1     no oil is lost
//   chamber_a  (V_A/beta) dp_A/dt =  q - A_A v - q_CL
//   chamber_b, piston             as in model/eha.hpp, with its symbols
//
// q: recorded flow [m3/s], between valve 1 and chamber A; q_P: the pump's, from port 2 to 1, and what drives it. Port 1
// opens valve 2, through which chamber B returns its oil. What the pump moves before valve 1 opens is not recorded, so
// that p_B comes 50 to 400 ms late where the piston turns back: there the simulation does not count (PlantPart). A
// constant p_B is wrong by the pressure that opens valve 1 (20 bar in the standard test), ever after: by 0.1 mm of x, and
// 3 to 11 % of R_CL.
#pragma once

#include <algorithm>

#include "sealwatch/model/eha.hpp"
#include "sealwatch/model/no_extra.hpp"

namespace sealwatch {

struct EhaFlowDriven {
  static constexpr int kStates = 6;
  template <class P>
  using Parameters = EhaParameters<P>;
  template <class S>
  using State = std::array<S, kStates>;  ///< p_1, p_2, p_A, p_B, v, x
  enum Index { kP1, kP2, kPA, kPB, kV, kX };
  struct Input {
    double flow_m3_s = 0.0;
  };

  /// Those of plant `eha` from its lines and valves on.
  static constexpr std::size_t kFirstSite = Eha::kDrop1;
  static constexpr auto kSites = [] {
    std::array<Site, Eha::kSites.size() - kFirstSite> sites = {};
    for (std::size_t k = 0; k < sites.size(); ++k) sites[k] = Eha::kSites[kFirstSite + k];
    return sites;
  }();

  /// What laws see at a site (model/physics.hpp). The power that warms the oil is the hydraulic one.
  template <class R, class S, class P, class Extra>
  [[nodiscard]] static std::array<R, kSiteSignals> signals(std::size_t site, const State<S>& y, const Input& input,
                                                           const EhaParameters<P>& p, const Extra& extra) {
    if (kFirstSite + site == Eha::kViscosity)
      return {R(laws::smooth_abs((y[kPA] - y[kPB]) * input.flow_m3_s, Eha::kPowerWidth_W)), R(0.0), R(0.0), R(0.0)};
    return Eha::signals<R>(kFirstSite + site, of_plant(y), {}, p, OfPlant<Extra>{extra});
  }

  template <class S, class P, class Extra = NoExtra>
  [[nodiscard]] static auto derivatives(const State<S>& y, const Input& input, const EhaParameters<P>& p,
                                        const Extra& extra = {}) {
    using R = decltype(y[0] * p.A_C + extra[0]);
    const auto& [p_1, p_2, p_A, p_B, v, x] = y;
    const OfPlant<Extra> added{extra};
    const double q = input.flow_m3_s;
    const auto viscosity = 1.0 + added[Eha::kViscosity];  // relative
    const auto q_CL = laws::laminar_flow(p_A - p_B, p.R_CL * viscosity) + added[Eha::kSealLeakage];
    const auto q_C1 = laws::make_up_flow(p.K_MU, p.p_0, p_1, p.s_MU);
    const auto q_C2 = laws::make_up_flow(p.K_MU, p.p_0, p_2, p.s_MU);
    const auto q_V1 = Eha::valve_flow(p_1, p_A, p_2, p, added[Eha::kDrop1], added[Eha::kCrack1]);
    const auto q_V2 = Eha::valve_flow(p_2, p_B, p_1, p, added[Eha::kDrop2], added[Eha::kCrack2]);
    const auto q_P = q + (q - q_V1) - q_C1;
    const auto A_A = p.A_C;
    const auto A_B = p.area_ratio * p.A_C;
    const auto V_A = p.V_0 + A_A * x;
    const auto V_B = p.V_0 + A_B * (p.x_C - x);
    const auto load = p.phi * (1.0 + p.load_factor);
    const auto force_losses = p.f_C * viscosity * v + load + Eha::cushion_force(x, v, p) + added[Eha::kPistonForce];
    return State<R>{
        R(Eha::stiffness(p.V_P, p.beta, added[Eha::kModulus1]) * (q - q_V1)),
        R(Eha::stiffness(p.V_P, p.beta, added[Eha::kModulus2]) * (-q_P - q_V2 + q_C2)),
        R(Eha::stiffness(V_A, p.beta, added[Eha::kModulusA], added[Eha::kComplianceA]) *
          (q - A_A * v - q_CL - added[Eha::kOutflowA])),
        R(Eha::stiffness(V_B, p.beta, added[Eha::kModulusB], added[Eha::kComplianceB]) *
          (q_V2 + A_B * v + q_CL - added[Eha::kOutflowB])),
        R((A_A * p_A - A_B * p_B - force_losses) / p.m_C),
        R(v),
    };
  }

 private:
  /// What is added at the sites of the whole plant: nothing at the motor and the pump.
  template <class Extra>
  struct OfPlant {
    const Extra& extra;
    using Value = std::remove_cvref_t<decltype(extra[0])>;
    constexpr Value operator[](std::size_t site) const {
      return site < kFirstSite ? Value{} : extra[site - kFirstSite];
    }
  };

  template <class S>
  [[nodiscard]] static Eha::State<S> of_plant(const State<S>& y) {
    Eha::State<S> plant{};
    std::copy(y.begin(), y.end(), plant.begin() + Eha::kP1);
    return plant;
  }
};

}  // namespace sealwatch

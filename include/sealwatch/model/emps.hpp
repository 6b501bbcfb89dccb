// Plant `emps`: electro-mechanical positioning drive (DC motor, ball screw, carriage on a linear guide), seen as one
// mass. Its current loop is so fast that the motor's force is proportional to the voltage command.
//
//   driver    F = k_F u                                  u  motor voltage command [V]
//   piston    M dv/dt = F - F_v v                        v  carriage velocity [m/s]
//             dx/dt = v                                  x  carriage position [m]
//
// M: mass of the carriage with the motor's inertia reduced to it [kg]; F_v: viscous friction [N s/m]; k_F: force per
// voltage [N/V]. Nothing holds the carriage back: x is an integral of v, and what the balance of forces lacks makes it
// drift. The naive model of A. Janot, M. Gautier, M. Brunot, Data Set and Reference Models of EMPS (2019), equation of
// the rigid model without its Coulomb friction and its constant offset. The carriage bears the element name `piston`,
// so that friction laws written for pistons serve it too.
#pragma once

#include <array>

#include "sealwatch/core/fields.hpp"
#include "sealwatch/model/laws.hpp"
#include "sealwatch/model/no_extra.hpp"
#include "sealwatch/model/sites.hpp"

namespace sealwatch {

template <class P>
struct EmpsParameters {
  P M, F_v, k_F;
  P load_factor;  ///< every plant's parameters end with it; this plant has no load that it could scale
  SEALWATCH_FIELDS(EmpsParameters, M, F_v, k_F, load_factor)
};

struct Emps {
  static constexpr int kStates = 2;
  template <class P>
  using Parameters = EmpsParameters<P>;
  template <class S>
  using State = std::array<S, kStates>;  ///< x, v
  enum Index { kX, kV };
  struct Input {
    double voltage_V = 0.0;
    double voltage_rate_V_s = 0.0;
  };

  /// Where laws of the catalogue may act, in the order of `extra`.
  static constexpr std::array kSites = {Site{"driver", SiteKind::voltage_command, Feeds::motor},
                                        Site{"piston", SiteKind::piston_force}};
  enum SiteIndex { kDriverVoltage, kPistonForce };

  /// What laws see at a site (model/physics.hpp). There is neither a current nor a pressure.
  template <class R, class S, class P, class Extra>
  [[nodiscard]] static std::array<R, kSiteSignals> signals(std::size_t site, const State<S>& y, const Input& input,
                                                           const EmpsParameters<P>&, const Extra&) {
    if (site == kDriverVoltage) return {R(0.0), R(input.voltage_V), R(input.voltage_rate_V_s), R(0.0)};
    return {R(y[kV]), R(y[kX]), R(0.0), R(0.0)};
  }

  template <class S, class P, class Extra = NoExtra>
  [[nodiscard]] static auto derivatives(const State<S>& y, const Input& input, const EmpsParameters<P>& p,
                                        const Extra& extra = {}) {
    const auto& [x, v] = y;
    const auto force = p.k_F * (input.voltage_V - extra[kDriverVoltage]);
    const auto acceleration = (force - p.F_v * v - extra[kPistonForce]) / p.M;
    using R = decltype(v + acceleration);
    return State<R>{R(v), R(acceleration)};
  }
};

}  // namespace sealwatch

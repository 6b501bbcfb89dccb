// Plant `cascaded_tanks`: a pump fills the upper of two tanks, which empties through a hole into the lower one, which
// empties through a hole into the reservoir. Levels are in volts of the level sensor.
//
//   upper_tank   dx_1/dt = k4 u - q_1,      q_1 = k1 r(x_1)         x_1  level of the upper tank [V]
//   lower_tank   dx_2/dt = a q_1 - q_2,     q_2 = k3 r(x_2)         x_2  level of the lower tank [V]
//   sensor       y = x_2
//
// u: pump voltage [V]; k4: rise of the upper level per pump voltage [1/s]; k1, k3: outlets [V^0.5/s]; a: bottom area of
// the upper tank over that of the lower one [1]; the k2 of the literature is a k1. The upper level is not measured: its
// scale, and with it a, cannot be told from recordings, and a = 1 chooses the scale in which both tanks are equal.
// Outflow after Bernoulli and Torricelli, r(x) = sqrt(x), rounded near an empty tank: r(x) = x / sqrt(|x| + 1 mV).
// M. Schoukens, P. Mattsson, T. Wigren, J.-P. Noel, Cascaded tanks benchmark combining soft and hard nonlinearities
// (2016), without overflow.
#pragma once

#include <array>

#include "sealwatch/core/fields.hpp"
#include "sealwatch/model/laws.hpp"
#include "sealwatch/model/no_extra.hpp"
#include "sealwatch/model/sites.hpp"

namespace sealwatch {

template <class P>
struct CascadedTanksParameters {
  P k4, k1, k3, area_ratio;
  P load_factor;  ///< every plant's parameters end with it; this plant has no load that it could scale
  SEALWATCH_FIELDS(CascadedTanksParameters, k4, k1, k3, area_ratio, load_factor)
};

struct CascadedTanks {
  static constexpr int kStates = 2;
  template <class P>
  using Parameters = CascadedTanksParameters<P>;
  template <class S>
  using State = std::array<S, kStates>;  ///< x_1, x_2
  enum Index { kUpper, kLower };
  struct Input {
    double pump_voltage_V = 0.0;
  };

  /// Where laws of the catalogue may act, in the order of `extra`: voltage that the pump loses; flow that leaves a tank
  /// for good, besides its outlet; flow that passes from the upper tank to the lower one, besides its outlet.
  static constexpr std::array kSites = {
      Site{"pump", SiteKind::voltage_command, Feeds::pump}, Site{"upper_tank", SiteKind::tank_flow},
      Site{"upper_outlet", SiteKind::tank_flow}, Site{"lower_tank", SiteKind::tank_flow}};
  enum SiteIndex { kPumpVoltage, kUpperFlow, kPassedFlow, kLowerFlow };

  /// What laws see at a site (model/physics.hpp): the command, or the level of the tank that the flow leaves.
  template <class R, class S, class P, class Extra>
  [[nodiscard]] static std::array<R, kSiteSignals> signals(std::size_t site, const State<S>& y, const Input& input,
                                                           const CascadedTanksParameters<P>&, const Extra&) {
    switch (site) {
      case kPumpVoltage:
        return {R(0.0), R(input.pump_voltage_V), R(0.0), R(0.0)};
      case kLowerFlow:
        return {R(y[kLower]), R(0.0), R(0.0), R(0.0)};
      default:
        return {R(y[kUpper]), R(0.0), R(0.0), R(0.0)};
    }
  }

  static constexpr double kRoundedLevel_V = 1e-3;  ///< far below it an outlet is linear in the level

  template <class S, class P, class Extra = NoExtra>
  [[nodiscard]] static auto derivatives(const State<S>& y, const Input& input, const CascadedTanksParameters<P>& p,
                                        const Extra& extra = {}) {
    const auto passed = p.k1 * laws::signed_root(y[kUpper], kRoundedLevel_V) + extra[kPassedFlow];
    const auto lower_outflow = p.k3 * laws::signed_root(y[kLower], kRoundedLevel_V);
    const auto inflow = p.k4 * (input.pump_voltage_V - extra[kPumpVoltage]);
    const auto upper_rate = inflow - passed - extra[kUpperFlow];
    const auto lower_rate = p.area_ratio * passed - lower_outflow - extra[kLowerFlow];
    using R = decltype(upper_rate + lower_rate);
    return State<R>{R(upper_rate), R(lower_rate)};
  }
};

}  // namespace sealwatch

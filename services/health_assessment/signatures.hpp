// What each fault would do to the judged quantities: its signature, to first order about the test's operating point.
//
// Operating point while extending against the load (+) and holding (h), from the test's own figures, else the asset's
// parameters (docs/model.md, steady state, line losses left out):
//   q_h = dp/R, q_+ = A v + dp/R, omega = (q + G_P dp)/alpha_P, i = (alpha_P dp + D omega)/T_M, u = E omega + R_M i
//
//   fault                     moves (by one unit of the fault)
//   internal_leakage          leakage_resistance -1          (hold_decay_rate +1 where no flow is recorded)
//   friction, running         friction_pressure +1, breakaway_pressure +1, load_free_current +alpha_P/T_M
//   friction, sticking        breakaway_pressure +1
//   pump slip                 pump_slip +1
//   pump drag                 shaft_drag +1, load_free_current +omega_+/T_M
//   load                      load_pressure +-1
//   driver                    back_emf +1                    (more voltage for the same speed)
//   sensor:flow, gain         leakage_resistance -R, pump_slip -q_h/dp, flow_gain +1, delivery_ratio +1
//   sensor:flow, bias         leakage_resistance -R/q_h, pump_slip -1/dp
//   sensor:pressure, bias     load_pressure +1, leakage_resistance +1/q_h, pump_slip -G_P/dp,
//                             shaft_drag -alpha_P/omega_+, load_free_current -alpha_P/T_M
//   sensor:shaft_speed        pump_slip +alpha_P omega_h/dp, shaft_drag -D, back_emf -E, delivery_ratio -1
//   sensor:motor_current      shaft_drag +T_M i/omega_+, back_emf -R_M i/omega_+, load_free_current +i
//   sensor:position           flow_gain -1, velocity_gain -1
//   sensor:velocity           velocity_gain +-1
//
// Leakage, friction, pump and driver faults have one sign; a load and a sensor may be off either way. motor_voltage is
// the command to the driver, not a measurement: what it does not deliver is the driver's fault. Channels are found by
// role, elements by the plant's sites: a fault for which a plant has neither is not proposed.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/message/health_assessment.hpp"
#include "services/health_assessment/deviations.hpp"

namespace sealwatch {

struct Signature {
  FaultKind kind = FaultKind::internal_leakage;
  std::string element;  ///< of the plant: sealwatch plant show
  bool either_sign = false;
  std::map<std::string, double> moves;  ///< quantity -> change in its unit
  bool can_fail_a_test = false;         ///< what stops the stroke, or its sensor
};

/// Signatures of all faults that can show in the quantities at hand, those of sensors that are in `channels`, and one
/// without moves for each suspect sensor that none of these is of. After a failed test, also those of the actuator's
/// faults that no quantity at hand shows.
[[nodiscard]] std::vector<Signature> fault_signatures(const AssetConfig& asset,
                                                      const std::vector<Deviation>& deviations,
                                                      const std::set<std::string>& channels,
                                                      const std::set<std::string>& suspects, bool failed = false);

}  // namespace sealwatch

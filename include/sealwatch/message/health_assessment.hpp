// Topic out of health assessment (ISO 13374 HA): health grade, ambiguity group of proposed faults, admissibility.
#pragma once

#include "sealwatch/message/common.hpp"

namespace sealwatch {

SEALWATCH_ENUM(FaultKind, internal_leakage, friction, pump, sensor, load, driver)

/// One member of the ambiguity group (OSA-CBM proposed event).
struct ProposedFault {
  FaultKind kind = FaultKind::internal_leakage;
  std::string element;             ///< element of INTERFACES section 5: "piston_seal", "sensor:pressure_a"
  double likelihood = 0.0;         ///< 0..1; all proposals and "no fault" add up to 1
  std::string iso14224_code;       ///< failure mode code, e.g. "INL" (internal leakage, valves)
  std::string iso14224_mechanism;  ///< failure mechanism code, e.g. "1.1 Leakage"
  std::vector<std::string> evidence;
  SEALWATCH_FIELDS(ProposedFault, kind, element, likelihood, iso14224_code, iso14224_mechanism, evidence)
  friend bool operator==(const ProposedFault&, const ProposedFault&) = default;
};

/// Topic health_report: one per test.
struct HealthReport {
  std::string asset_id;       // key
  Header header;              ///< message_id "health_report/<pst_id>"
  double health_grade = 1.0;  ///< 0 (failed) .. 1 (as new)
  bool trend_known = false;
  double health_trend_per_year = 0.0;  ///< slope of the grade over the last tests
  double health_trend_std_per_year = 0.0;
  double no_fault_likelihood = 1.0;
  std::vector<ProposedFault> ambiguity_group;  ///< most likely first
  bool admissible_for_prognosis = true;
  std::vector<std::string> inadmissible_reasons;  ///< "cut after 7.4 s of about 31 s", empty when admissible
  SEALWATCH_FIELDS(HealthReport, asset_id, header, health_grade, trend_known, health_trend_per_year,
                   health_trend_std_per_year, no_fault_likelihood, ambiguity_group, admissible_for_prognosis,
                   inadmissible_reasons)
  friend bool operator==(const HealthReport&, const HealthReport&) = default;
};

}  // namespace sealwatch

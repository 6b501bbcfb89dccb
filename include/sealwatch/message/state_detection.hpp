// Topics out of state detection (ISO 13374 SD): alert regions, PST verdict, overdue tests.
#pragma once

#include "sealwatch/message/common.hpp"

namespace sealwatch {

SEALWATCH_ENUM(AlertRegion, normal, advisory, warning, alarm)
SEALWATCH_ENUM(PstVerdict, passed, failed, aborted, not_judged)
/// What a residual was judged against: the datasheet's model, the asset's own first tests, or its first tests with the
/// model that an operator accepted.
SEALWATCH_ENUM(Reference, limit, nominal_model, own_baseline, accepted_model)

/// One judged quantity with its region after hysteresis and delay.
struct RegionJudgement {
  std::string quantity;  ///< "hold_decay_Pa_s", "residual.pressure_a"
  Reference reference = Reference::limit;
  std::string unit;
  double value = 0.0;
  double advisory_limit = 0.0;  ///< the limits on the side that was approached, in `unit`
  double warning_limit = 0.0;
  double alarm_limit = 0.0;
  AlertRegion raw_region = AlertRegion::normal;  ///< of this test alone
  AlertRegion region = AlertRegion::normal;      ///< after hysteresis and delay
  std::int32_t tests_in_raw_region = 0;          ///< consecutive, this one included
  SEALWATCH_FIELDS(RegionJudgement, quantity, reference, unit, value, advisory_limit, warning_limit, alarm_limit,
                   raw_region, region, tests_in_raw_region)
  friend bool operator==(const RegionJudgement&, const RegionJudgement&) = default;
};

/// Simulation minus recording of one channel.
struct ResidualSummary {
  std::string channel;
  Reference reference = Reference::nominal_model;
  double noise_normalised_rms = 0.0;  ///< 1 is the floor
  double nrmse_percent = 0.0;         ///< 100 (1 - |y - y_hat| / |y - mean y|)
  SEALWATCH_FIELDS(ResidualSummary, channel, reference, noise_normalised_rms, nrmse_percent)
  friend bool operator==(const ResidualSummary&, const ResidualSummary&) = default;
};

/// Topic state_report: one per test, and one when a test becomes overdue (header.pst_id then empty).
struct StateReport {
  std::string asset_id;  // key
  Header header;         ///< message_id "state_report/<pst_id>" or "state_report/<asset>/overdue/<due date>"
  PstVerdict verdict = PstVerdict::not_judged;
  std::vector<std::string> verdict_reasons;
  AlertRegion region = AlertRegion::normal;  ///< worst of the judgements
  std::vector<RegionJudgement> judgements;
  std::vector<ResidualSummary> residuals;
  bool pst_overdue = false;   ///< at the event time of this report a test was overdue, or this test came late
  double overdue_days = 0.0;  ///< by how much
  std::vector<std::string> stale_channels;
  std::string accepted_discrepancy;    ///< model_discrepancy whose model was judged besides; "" none
  bool retracted_tests_known = false;  ///< in an answer to "all since a date": the tests that it means are named
  std::vector<std::string> retracted_test_ids;
  SEALWATCH_FIELDS(StateReport, asset_id, header, verdict, verdict_reasons, region, judgements, residuals, pst_overdue,
                   overdue_days, stale_channels, accepted_discrepancy, retracted_tests_known, retracted_test_ids)
  friend bool operator==(const StateReport&, const StateReport&) = default;
};

}  // namespace sealwatch

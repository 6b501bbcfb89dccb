// Topics out of prognostic assessment (ISO 13374 PA): the estimate of the leakage resistance, the remaining useful
// life, and the request for a test.
#pragma once

#include "sealwatch/estimation/fit_report.hpp"
#include "sealwatch/forecast/forecast.hpp"
#include "sealwatch/message/common.hpp"

namespace sealwatch {

/// Topic leakage_estimate: one per test, also for tests that were left out (with the reason).
struct LeakageEstimate {
  std::string asset_id;             // key
  Header header;                    ///< message_id "leakage_estimate/<pst_id>"
  bool estimated = false;           ///< false: no estimate was possible at all, reasons say why
  double resistance_Pa_s_m3 = 0.0;  ///< R_CL; of other plants the parameter that wears, in its own unit
  double resistance_std_Pa_s_m3 = 0.0;
  bool condition_known = false;  ///< theta is defined (the asset has seal resistances)
  double condition = 0.0;        ///< theta: leakage-derived condition index
  double condition_std = 0.0;
  bool used_for_forecast = false;
  std::vector<std::string> reasons;  ///< why it was left out
  std::vector<FitReport> fits;       ///< cylinder circuit, and whole actuator where it could be run
  std::string chosen_model;          ///< which fit R_CL was taken from
  std::string accepted_discrepancy;  ///< model_discrepancy whose model was fitted; "" the asset file's
  std::string parameter;             ///< whose value it is: "R_CL"
  std::string unit;                  ///< of it: "Pa s/m3"
  SEALWATCH_FIELDS(LeakageEstimate, asset_id, header, estimated, resistance_Pa_s_m3, resistance_std_Pa_s_m3,
                   condition_known, condition, condition_std, used_for_forecast, reasons, fits, chosen_model,
                   accepted_discrepancy, parameter, unit)
  friend bool operator==(const LeakageEstimate&, const LeakageEstimate&) = default;
};

/// One row of the decision table: replacing the seal at a date, or waiting for its failure.
struct DecisionOption {
  std::string label;  ///< "now", the campaign's, "wait for failure"
  std::int64_t at_ns = 0;
  double months = 0.0;               ///< from the test; for waiting the median remaining life
  double failure_probability = 0.0;  ///< before that date; for waiting 1
  bool cost_known = false;           ///< the site gives its costs
  double expected_cost = 0.0;
  std::string currency;
  bool cheapest = false;
  SEALWATCH_FIELDS(DecisionOption, label, at_ns, months, failure_probability, cost_known, expected_cost, currency,
                   cheapest)
  friend bool operator==(const DecisionOption&, const DecisionOption&) = default;
};

/// Topic remaining_life: one per test.
struct RemainingLife {
  std::string asset_id;    // key
  Header header;           ///< message_id "remaining_life/<pst_id>"
  double threshold = 0.0;  ///< theta_max
  double condition = 0.0;  ///< latest theta that was used
  bool condition_known = false;
  double condition_std = 0.0;
  std::vector<Forecast> forecasts;  ///< windows side by side; the primary one first
  bool windows_disagree = false;    ///< prediction intervals of two windows do not overlap
  std::string disagreement;
  std::int32_t tests_since_replacement = 0;
  /// Earlier forecasts of the condition by the primary forecaster, against the estimates that have come since.
  std::int32_t scored_forecasts = 0;  ///< 0: the shares and the CRPS say nothing yet
  double coverage_80 = 0.0;           ///< share of those estimates within the 80 % interval
  double coverage_95 = 0.0;
  double mean_crps = 0.0;   ///< of theta [1]
  double confidence = 0.0;  ///< 0..1 that the forecaster still describes this seal; 0 where nothing is forecast
  std::vector<DecisionOption> decision;  ///< by the primary forecaster, in the order of time; empty without a forecast
  bool replacement_known = false;        ///< a replacement of this seal or actuator has been reported
  std::int64_t replaced_ns = 0;          ///< when: only tests since then count
  SEALWATCH_FIELDS(RemainingLife, asset_id, header, threshold, condition, condition_known, condition_std, forecasts,
                   windows_disagree, disagreement, tests_since_replacement, scored_forecasts, coverage_80, coverage_95,
                   mean_crps, confidence, decision, replacement_known, replaced_ns)
  friend bool operator==(const RemainingLife&, const RemainingLife&) = default;
};

/// Topic pst_request: prognosis asks for a test; the Master Control System decides.
struct PstRequest {
  std::string asset_id;  // key
  Header header;         ///< message_id "pst_request/<pst_id>"
  std::int64_t due_time_ns = 0;
  std::string reason;  ///< "monthly test", "last test was cut: repeat"
  SEALWATCH_FIELDS(PstRequest, asset_id, header, due_time_ns, reason)
  friend bool operator==(const PstRequest&, const PstRequest&) = default;
};

}  // namespace sealwatch

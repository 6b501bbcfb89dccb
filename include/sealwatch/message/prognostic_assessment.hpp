// Topics out of prognostic assessment (ISO 13374 PA): the estimate of the leakage resistance, the remaining useful
// life, and the request for a test.
#pragma once

#include "sealwatch/message/common.hpp"

namespace sealwatch {

SEALWATCH_ENUM(ForecastState, ok, no_significant_trend, insufficient_history, past_threshold)

/// Fit quality of one channel.
struct ChannelFit {
  std::string channel;
  double noise_normalised_rms = 0.0;
  double nrmse_percent = 0.0;
  double whiteness_p = 0.0;     ///< Ljung-Box on the residual
  double independence_p = 0.0;  ///< residual against past input
  SEALWATCH_FIELDS(ChannelFit, channel, noise_normalised_rms, nrmse_percent, whiteness_p, independence_p)
  friend bool operator==(const ChannelFit&, const ChannelFit&) = default;
};

/// An estimated parameter with its bounds psi_min <= psi <= psi_max.
struct EstimatedParameter {
  std::string name;
  std::string unit;
  double value = 0.0;
  double std_error = 0.0;
  double min = 0.0;
  double max = 0.0;
  bool free = true;
  bool at_bound = false;
  SEALWATCH_FIELDS(EstimatedParameter, name, unit, value, std_error, min, max, free, at_bound)
  friend bool operator==(const EstimatedParameter&, const EstimatedParameter&) = default;
};

/// Result of one PEM run.
struct FitReport {
  std::string model;        ///< "cylinder_circuit", "eha", "eha_switched"
  std::string termination;  ///< why the optimiser stopped, in words
  bool converged = false;
  std::int32_t iterations = 0;
  double cost = 0.0;         ///< 1/2 sum of squared whitened residuals
  double load_factor = 0.0;  ///< Phi of this test
  std::vector<EstimatedParameter> parameters;
  std::vector<double> covariance;  ///< row-major, free parameters in the order of `parameters`
  std::vector<ChannelFit> channels;
  bool admissible = false;
  std::vector<std::string> reasons;  ///< why not admissible
  SEALWATCH_FIELDS(FitReport, model, termination, converged, iterations, cost, load_factor, parameters, covariance,
                   channels, admissible, reasons)
  friend bool operator==(const FitReport&, const FitReport&) = default;
};

/// Topic leakage_estimate: one per test, also for tests that were left out (with the reason).
struct LeakageEstimate {
  std::string asset_id;             // key
  Header header;                    ///< message_id "leakage_estimate/<pst_id>"
  bool estimated = false;           ///< false: no estimate was possible at all, reasons say why
  double resistance_Pa_s_m3 = 0.0;  ///< R_CL
  double resistance_std_Pa_s_m3 = 0.0;
  bool condition_known = false;  ///< theta is defined (the asset has seal resistances)
  double condition = 0.0;        ///< theta: share of the nominal elastic modulus
  double condition_std = 0.0;
  bool used_for_forecast = false;
  std::vector<std::string> reasons;  ///< why it was left out
  std::vector<FitReport> fits;       ///< cylinder circuit, and whole actuator where it could be run
  std::string chosen_model;          ///< which fit R_CL was taken from
  std::string accepted_discrepancy;  ///< model_discrepancy whose model was fitted; "" the asset file's
  SEALWATCH_FIELDS(LeakageEstimate, asset_id, header, estimated, resistance_Pa_s_m3, resistance_std_Pa_s_m3,
                   condition_known, condition, condition_std, used_for_forecast, reasons, fits, chosen_model,
                   accepted_discrepancy)
  friend bool operator==(const LeakageEstimate&, const LeakageEstimate&) = default;
};

/// Probability of failure before a date.
struct FailureProbability {
  std::int64_t before_ns = 0;
  std::string label;  ///< "campaign 2031"
  double probability = 0.0;
  SEALWATCH_FIELDS(FailureProbability, before_ns, label, probability)
  friend bool operator==(const FailureProbability&, const FailureProbability&) = default;
};

/// One forecaster's answer. Numbers are valid only in state ok (and past_threshold: all zero).
struct Forecast {
  std::string method;  ///< "ols", "ols_log_time", ...
  std::int32_t window_months = 0;
  ForecastState state = ForecastState::insufficient_history;
  std::string explanation;  ///< "12 of 24 tests so far"
  std::int32_t tests_used = 0;
  double rul_months = 0.0;  ///< t_RUL, the point forecast
  double rul_p10_months = 0.0;
  double rul_p50_months = 0.0;
  double rul_p90_months = 0.0;
  double interval_95_low_months = 0.0;
  double interval_95_high_months = 0.0;
  std::int64_t end_of_life_ns = 0;
  std::vector<FailureProbability> failure_probability;
  SEALWATCH_FIELDS(Forecast, method, window_months, state, explanation, tests_used, rul_months, rul_p10_months,
                   rul_p50_months, rul_p90_months, interval_95_low_months, interval_95_high_months, end_of_life_ns,
                   failure_probability)
  friend bool operator==(const Forecast&, const Forecast&) = default;
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
  std::vector<Forecast> forecasts;  ///< windows side by side; the one in charge first
  bool windows_disagree = false;    ///< prediction intervals of two windows do not overlap
  std::string disagreement;
  std::int32_t tests_since_replacement = 0;
  /// Earlier forecasts of the condition by the forecaster in charge, against the estimates that have come since.
  std::int32_t scored_forecasts = 0;  ///< 0: the shares and the CRPS say nothing yet
  double coverage_80 = 0.0;           ///< share of those estimates within the 80 % interval
  double coverage_95 = 0.0;
  double mean_crps = 0.0;   ///< of theta [1]
  double confidence = 0.0;  ///< 0..1 that the forecaster still describes this seal; 0 where nothing is forecast
  std::vector<DecisionOption>
      decision;                    ///< by the forecaster in charge, in the order of time; empty without a forecast
  bool replacement_known = false;  ///< a replacement of this seal or actuator has been reported
  std::int64_t replaced_ns = 0;    ///< when: only tests since then count
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

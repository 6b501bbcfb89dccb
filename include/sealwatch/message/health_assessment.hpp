// Topic out of health assessment (ISO 13374 HA): health grade, ambiguity group of proposed faults, admissibility.
#pragma once

#include "sealwatch/message/common.hpp"

namespace sealwatch {

SEALWATCH_ENUM(FaultKind, internal_leakage, friction, pump, sensor, load, driver)

/// One member of the ambiguity group (OSA-CBM proposed event).
struct ProposedFault {
  FaultKind kind = FaultKind::internal_leakage;
  std::string element;             ///< element of the plant: "piston_seal", "sensor:pressure_a"
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
  double health_grade = 0.0;  ///< 0 (failed) .. 1 (as new), where it is known
  bool trend_known = false;
  double health_trend_per_year = 0.0;  ///< slope of the grade over the last tests
  double health_trend_std_per_year = 0.0;
  double no_fault_likelihood = 1.0;
  std::vector<ProposedFault> ambiguity_group;  ///< most likely first
  bool admissible_for_prognosis = true;
  std::vector<std::string> inadmissible_reasons;  ///< "cut after 7.4 s of about 31 s", empty when admissible
  bool health_grade_known = false;                ///< false until a test has measured the seal
  bool retracted_tests_known = false;             ///< as in the state_report that it answers
  std::vector<std::string> retracted_test_ids;
  SEALWATCH_FIELDS(HealthReport, asset_id, header, health_grade, trend_known, health_trend_per_year,
                   health_trend_std_per_year, no_fault_likelihood, ambiguity_group, admissible_for_prognosis,
                   inadmissible_reasons, health_grade_known, retracted_tests_known, retracted_test_ids)
  friend bool operator==(const HealthReport&, const HealthReport&) = default;
};

SEALWATCH_ENUM(DiscrepancyVerdict, consistent, mismatch, undetermined)

/// One parameter of the explained model, SI unit of the model's parameter table.
struct ModelParameter {
  std::string name;
  double value = 0.0;
  double min = 0.0;
  double max = 0.0;
  bool estimate = false;  ///< whether later fits may estimate it
  SEALWATCH_FIELDS(ModelParameter, name, value, min, max, estimate)
  friend bool operator==(const ModelParameter&, const ModelParameter&) = default;
};

/// One law that the explained model adds to an element.
struct ModelPhysics {
  std::string id;  ///< of docs/laws.md
  std::string element;
  std::vector<ModelParameter> parameters;
  SEALWATCH_FIELDS(ModelPhysics, id, element, parameters)
  friend bool operator==(const ModelPhysics&, const ModelPhysics&) = default;
};

/// The asset's model as explained: what state detection and prognosis simulate with once it is accepted.
struct ExplainedModel {
  std::string model;                       ///< "eha", ...
  std::vector<ModelParameter> parameters;  ///< all of the model's
  std::vector<ModelPhysics> physics;
  SEALWATCH_FIELDS(ExplainedModel, model, parameters, physics)
  friend bool operator==(const ExplainedModel&, const ExplainedModel&) = default;
};

/// A place where what is missing may sit.
struct DiscrepancyLocation {
  std::string element;
  double probability = 0.0;
  std::vector<std::string> indistinguishable_from;  ///< elements that these tests cannot tell from it
  std::string evidence;
  SEALWATCH_FIELDS(DiscrepancyLocation, element, probability, indistinguishable_from, evidence)
  friend bool operator==(const DiscrepancyLocation&, const DiscrepancyLocation&) = default;
};

/// A law that was found.
struct DiscrepancyPhysics {
  std::string id;  ///< of docs/laws.md, or "unlisted"
  std::string element;
  std::string law;      ///< closed form
  std::string meaning;  ///< for an engineer
  double probability = 0.0;
  std::string regime;  ///< where it acts
  std::vector<Quantity> parameters;
  std::vector<std::string> indistinguishable_from;  ///< "coulomb at load": laws that these tests cannot tell from it
  SEALWATCH_FIELDS(DiscrepancyPhysics, id, element, law, meaning, probability, regime, parameters,
                   indistinguishable_from)
  friend bool operator==(const DiscrepancyPhysics&, const DiscrepancyPhysics&) = default;
};

/// Misfit of one channel over the tests kept aside, in standard deviations of the noise: 1 is the floor.
struct DiscrepancyChannel {
  std::string channel;
  double rms_before = 0.0;
  double rms_after = 0.0;
  SEALWATCH_FIELDS(DiscrepancyChannel, channel, rms_before, rms_after)
  friend bool operator==(const DiscrepancyChannel&, const DiscrepancyChannel&) = default;
};

/// Topic model_discrepancy: what the mismatch analysis found after residuals that persist.
struct ModelDiscrepancy {
  std::string asset_id;                // key
  Header header;                       ///< message_id "model_discrepancy/<pst_id>" of the latest test analysed
  std::int32_t version = 1;            ///< 1, 2, ... since the last replacement
  std::vector<std::string> reasons;    ///< which residuals persist, in words
  std::vector<std::string> fit_tests;  ///< pst_ids
  std::vector<std::string> holdout_tests;
  bool analysed = false;  ///< false: the analysis was not possible, failure says why
  std::string failure;
  DiscrepancyVerdict verdict = DiscrepancyVerdict::undetermined;
  double p_value = 1.0;                       ///< that simulation and recordings differ by noise alone, after fitting
  double explained_share = 0.0;               ///< of the excess misfit
  std::vector<DiscrepancyLocation> location;  ///< most probable first
  std::vector<DiscrepancyPhysics> physics;
  std::vector<DiscrepancyChannel> holdout;
  std::string summary;    ///< two or three sentences for a maintenance engineer
  std::string next_test;  ///< what to record to settle what is open
  ExplainedModel explained;
  std::string explained_asset_yaml;  ///< the same as an asset file
  SEALWATCH_FIELDS(ModelDiscrepancy, asset_id, header, version, reasons, fit_tests, holdout_tests, analysed, failure,
                   verdict, p_value, explained_share, location, physics, holdout, summary, next_test, explained,
                   explained_asset_yaml)
  friend bool operator==(const ModelDiscrepancy&, const ModelDiscrepancy&) = default;
};

/// Topic model_acceptance: an operator lets the services simulate with an explained model, or no longer.
struct ModelAcceptance {
  std::string asset_id;  // key
  Header header;         ///< message_id "model_acceptance/<asset>/<time>"
  std::string discrepancy_id;
  std::int32_t version = 0;  ///< of the discrepancy
  bool revoked = false;      ///< true: from now on the asset's file again
  std::string accepted_by;
  std::string remark;
  std::int64_t discrepancy_time_ns = 0;  ///< latest test analysed: a replacement after it ends the acceptance
  ExplainedModel explained;
  SEALWATCH_FIELDS(ModelAcceptance, asset_id, header, discrepancy_id, version, revoked, accepted_by, remark,
                   discrepancy_time_ns, explained)
  friend bool operator==(const ModelAcceptance&, const ModelAcceptance&) = default;
};

}  // namespace sealwatch

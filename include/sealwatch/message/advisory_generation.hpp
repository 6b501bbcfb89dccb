// Topics out of and into advisory generation (ISO 13374 AG).
#pragma once

#include "sealwatch/message/common.hpp"
#include "sealwatch/message/prognostic_assessment.hpp"

namespace sealwatch {

SEALWATCH_ENUM(AdvisoryPriority, information, low, medium, high, urgent)
SEALWATCH_ENUM(AdvisoryAction, none, repeat_test, inspect_instrumentation, plan_replacement, book_vessel, replace_now,
               examine_actuator)
SEALWATCH_ENUM(AdvisoryState, active, acknowledged, superseded)

/// OSA-CBM request for work: what a maintenance management system needs to make a work order.
struct RequestForWork {
  std::string work_id;           ///< same for the same piece of work over all its revisions
  std::string work_type;         ///< "replace actuator"
  std::string segment;           ///< where: site and segment of the asset
  std::string solution_package;  ///< what to bring
  bool start_before_known = false;
  std::int64_t start_before_ns = 0;  ///< latest-by date
  std::string remarks;
  SEALWATCH_FIELDS(RequestForWork, work_id, work_type, segment, solution_package, start_before_known, start_before_ns,
                   remarks)
  friend bool operator==(const RequestForWork&, const RequestForWork&) = default;
};

/// Proof tests and what the leak leaves of the valve's closing.
struct SafetyBook {
  bool failure_probability_known = false;      ///< the site gives its rate of failures
  double failure_probability_on_demand = 0.0;  ///< PFDavg
  bool partial_stroke_known = false;
  std::int64_t partial_stroke_due_ns = 0;
  double partial_stroke_overdue_days = 0.0;  ///< by how much this one came late
  bool full_stroke_known = false;
  std::int64_t full_stroke_due_ns = 0;
  double full_stroke_overdue_months = 0.0;  ///< at the time of this test
  bool margin_known = false;                ///< the test gave an estimate of the leak
  double closing_time_margin = 0.0;         ///< limit / closing time - 1; -1: it does not close
  double closing_force_margin = 0.0;        ///< available / needed - 1
  SEALWATCH_FIELDS(SafetyBook, failure_probability_known, failure_probability_on_demand, partial_stroke_known,
                   partial_stroke_due_ns, partial_stroke_overdue_days, full_stroke_known, full_stroke_due_ns,
                   full_stroke_overdue_months, margin_known, closing_time_margin, closing_force_margin)
  friend bool operator==(const SafetyBook&, const SafetyBook&) = default;
};

/// Topic advisory: the current recommendation for one asset. A test that changes nothing repeats the advisory_id with a
/// higher revision; a different recommendation has a new id and names the one it supersedes.
struct Advisory {
  std::string asset_id;  // key
  Header header;         ///< message_id "advisory/<pst_id>", ".../acknowledged/<hash>" for acknowledgements
  std::string advisory_id;
  std::int32_t revision = 1;
  AdvisoryState state = AdvisoryState::active;
  std::string supersedes_id;  ///< advisory_id, "" if none
  AdvisoryPriority priority = AdvisoryPriority::information;
  AdvisoryAction action = AdvisoryAction::none;
  std::string recommendation;  ///< one or two sentences for the operator on shift
  bool latest_by_known = false;
  std::int64_t latest_by_ns = 0;
  std::vector<std::string> reasons;              ///< in words; header.source_ids names the messages behind them
  std::vector<RequestForWork> request_for_work;  ///< none or one
  std::string acknowledged_by;
  std::int64_t acknowledged_at_ns = 0;
  std::string acknowledgement_remark;
  std::vector<DecisionOption> decision;  ///< of the test's remaining_life
  std::vector<SafetyBook> safety;        ///< one; none from an older writer (a lone struct would end the reader)
  SEALWATCH_FIELDS(Advisory, asset_id, header, advisory_id, revision, state, supersedes_id, priority, action,
                   recommendation, latest_by_known, latest_by_ns, reasons, request_for_work, acknowledged_by,
                   acknowledged_at_ns, acknowledgement_remark, decision, safety)
  friend bool operator==(const Advisory&, const Advisory&) = default;
};

/// Topic acknowledgement: an operator has seen an advisory.
struct Acknowledgement {
  std::string asset_id;  // key
  Header header;         ///< message_id "acknowledgement/<advisory_id>/<revision>"
  std::string advisory_id;
  std::string acknowledged_by;
  std::string remark;
  SEALWATCH_FIELDS(Acknowledgement, asset_id, header, advisory_id, acknowledged_by, remark)
  friend bool operator==(const Acknowledgement&, const Acknowledgement&) = default;
};

/// Topic maintenance_event: the actuator was replaced (or its seal): histories start anew at event_time_ns.
struct MaintenanceEvent {
  std::string asset_id;  // key
  Header header;         ///< message_id "maintenance_event/<asset>/<kind>/<reported at>/<event time>"
  std::string kind;      ///< "actuator_replaced" | "seal_replaced"
  std::string reported_by;
  std::string remark;
  bool tests_known = false;           ///< of "tests_retracted": the tests that it means are named, by who took it first
  std::vector<std::string> test_ids;  ///< PST ids
  SEALWATCH_FIELDS(MaintenanceEvent, asset_id, header, kind, reported_by, remark, tests_known, test_ids)
  friend bool operator==(const MaintenanceEvent&, const MaintenanceEvent&) = default;
};

}  // namespace sealwatch

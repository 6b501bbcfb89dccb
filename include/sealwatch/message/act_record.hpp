// Topic act_record: what people said, as a service recorded it. Acts are said once, by people who go home: whoever
// listens to them keeps each in a stream of its own, which the others read like any other. So a service whose journal
// was lost, or is an older backup, has them back from its neighbours (runtime/layer_runner_records.cpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sealwatch/message/advisory_generation.hpp"
#include "sealwatch/message/health_assessment.hpp"

namespace sealwatch {

struct ActRecord {
  std::string asset_id;  // key
  Header header;         ///< message_id "act_record/<service>/<hash of the act's id>", producer the service
  /// One of these three holds the act, as it came.
  std::vector<MaintenanceEvent> events;
  std::vector<ModelAcceptance> acceptances;
  std::vector<Acknowledgement> acknowledgements;
  /// What it means was not known to the service when it came.
  bool is_ahead = false;
  SEALWATCH_FIELDS(ActRecord, asset_id, header, events, acceptances, acknowledgements, is_ahead)
  friend bool operator==(const ActRecord&, const ActRecord&) = default;
};

}  // namespace sealwatch

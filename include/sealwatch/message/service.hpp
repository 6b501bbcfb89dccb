// Topics by which the services keep each other honest: heartbeat with stream positions, and requests to send again.
//
// How nothing is lost. Every writer numbers its messages of a topic 1, 2, 3, ... in its journal. Its heartbeat says how
// far each of its streams goes; a reader that is behind (it was dead, the writer was dead, a burst was dropped) asks
// for the missing ones with resend_request, and the writer publishes them again from its journal.
#pragma once

#include "sealwatch/message/common.hpp"

namespace sealwatch {

/// State of a service that works, and has not recalled the past of all its assets yet; else "running", "stopping".
inline constexpr const char* kRestoring = "restoring";

struct StreamPosition {
  std::string topic;
  std::string writer_id;
  std::uint64_t sequence = 0;  ///< last one written, or last one received without a gap
  SEALWATCH_FIELDS(StreamPosition, topic, writer_id, sequence)
  friend bool operator==(const StreamPosition&, const StreamPosition&) = default;
};

/// Something that a service cannot mend by itself, for as long as it stands.
struct ServiceAlarm {
  std::string kind;      ///< "set_aside": the layer failed on a message twice; "unknown_writer"; "rival"
  std::string asset_id;  ///< "" where it is about none
  std::string subject;   ///< message id, writer id, ...
  std::string pst_id;    ///< "" where it is about no test
  std::string text;      ///< what happened
  std::int64_t since_ns = 0;
  std::string ne107 = {};  ///< in words, as ne107.hpp has them: "failure"
  SEALWATCH_FIELDS(ServiceAlarm, kind, asset_id, subject, pst_id, text, since_ns, ne107)
  friend bool operator==(const ServiceAlarm&, const ServiceAlarm&) = default;
};

/// What became of an alarm of any service, or of an advisory that asks for something: its state after ISA-18.2 and
/// IEC 62682 (alarm_state.hpp), kept by advisory_generation.
struct AlarmEntry {
  std::string service;  ///< who told it first
  ServiceAlarm alarm;
  std::int64_t due_ns = 0;    ///< by when an advisory asks for it; 0 without a date
  std::int64_t ended_ns = 0;  ///< when it returned to normal; 0 while it is active
  std::string acknowledged_by;
  std::int64_t acknowledged_at_ns = 0;
  std::string shelved_by;
  std::string shelved_reason;
  std::int64_t shelved_until_ns = 0;  ///< 0: it is not shelved
  std::string suppressed_by;          ///< the active alarm that causes it, by design; "" none
  std::string out_of_service_by;      ///< who took its asset out of service; "" nobody
  SEALWATCH_FIELDS(AlarmEntry, service, alarm, due_ns, ended_ns, acknowledged_by, acknowledged_at_ns, shelved_by,
                   shelved_reason, shelved_until_ns, suppressed_by, out_of_service_by)
  friend bool operator==(const AlarmEntry&, const AlarmEntry&) = default;
};

/// Topic service_status: about once a second from each service.
struct ServiceStatus {
  std::string service;  // key: "data_acquisition", ...
  std::string writer_id;
  std::string version;
  std::int64_t started_ns = 0;
  std::int64_t publishing_time_ns = 0;
  std::int32_t process_id = 0;
  std::uint64_t pending_inputs = 0;  ///< received, not yet concluded from
  std::vector<StreamPosition> written;
  std::vector<StreamPosition> received;
  std::string state;                 ///< "running", "stopping"
  std::string last_error;            ///< "" if none
  std::vector<ServiceAlarm> alarms;  ///< those that stand, the newest few
  std::uint64_t alarm_count = 0;     ///< all that stand
  std::vector<AlarmEntry> desk;      ///< of advisory_generation: all alarms with their states, the most pressing first
  std::uint64_t desk_count = 0;      ///< how many there are, told or not
  std::string ne107;                 ///< the most pressing of all that stand here, or of `state`: "good"
  SEALWATCH_FIELDS(ServiceStatus, service, writer_id, version, started_ns, publishing_time_ns, process_id,
                   pending_inputs, written, received, state, last_error, alarms, alarm_count, desk, desk_count, ne107)
  friend bool operator==(const ServiceStatus&, const ServiceStatus&) = default;
};

/// Topic resend_request.
struct ResendRequest {
  std::string writer_id;  // key: whose stream
  std::string topic;
  std::uint64_t first_sequence = 0;
  std::uint64_t last_sequence = 0;
  std::string requested_by;
  SEALWATCH_FIELDS(ResendRequest, writer_id, topic, first_sequence, last_sequence, requested_by)
  friend bool operator==(const ResendRequest&, const ResendRequest&) = default;
};

}  // namespace sealwatch

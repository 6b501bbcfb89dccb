// What every message of sealwatch carries, and the small types that several layers' messages share.
// SI units; a physical field's name ends in its unit; times are UTC nanoseconds since 1970.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sealwatch/core/clock_reading.hpp"
#include "sealwatch/core/fields.hpp"
#include "sealwatch/core/time_series.hpp"

namespace sealwatch {

/// Version of all message layouts. Raised when a field changes its meaning; added fields do not raise it.
inline constexpr std::int32_t kSchemaVersion = 1;

/// Provenance and times of a message. A message's id is a pure function of what it says and about which test, so that
/// concluding the same thing twice gives the same id: "<topic>/<pst_id>" for conclusions from one test.
struct Header {
  std::int32_t schema_version = kSchemaVersion;
  std::string message_id;
  std::string pst_id;                   ///< the test this belongs to, "" when it belongs to none
  std::vector<std::string> source_ids;  ///< message ids this was concluded from, down to the waveform
  std::string producer;                 ///< "state_detection 0.1.0"
  bool event_time_known = false;        ///< false for recordings without start_time
  std::int64_t event_time_ns = 0;       ///< when it happened at the actuator (start of the test)
  std::int64_t publishing_time_ns = 0;  ///< when the producer published it; stamped at publishing, not journaled
  bool replay = false;                  ///< recorded data played back, not live
  std::string writer_id;                ///< which writer's stream stream_sequence counts in
  std::uint64_t stream_sequence = 0;    ///< 1, 2, 3, ... without gaps for each topic and writer; stamped by the journal
  std::int64_t writer_started_ns = 0;   ///< started_ns of the writer's heartbeat; stamped at publishing, 0 from outside
  ClockQuality clock_quality = ClockQuality::unknown;  ///< of the clock of who published it, at that time; stamped then
  bool clock_error_known = false;
  double clock_error_s = 0.0;  ///< estimated error of that clock
  SEALWATCH_FIELDS(Header, schema_version, message_id, pst_id, source_ids, producer, event_time_known, event_time_ns,
                   publishing_time_ns, replay, writer_id, stream_sequence, writer_started_ns, clock_quality,
                   clock_error_known, clock_error_s)
  friend bool operator==(const Header&, const Header&) = default;
};

inline void stamp_clock(Header& header, const ClockReading& clock) {
  header.clock_quality = clock.quality;
  header.clock_error_known = clock.error_known;
  header.clock_error_s = clock.error_s;
}

/// OSA-CBM data acquisition status of one channel.
SEALWATCH_ENUM(ChannelState, OK, FAILED, UNKNOWN, NOT_USED)

struct ChannelStatus {
  std::string channel;
  ChannelState state = ChannelState::UNKNOWN;
  std::string reason;  ///< "frozen for 1.2 s from 3.4 s", "" when OK
  SEALWATCH_FIELDS(ChannelStatus, channel, state, reason)
  friend bool operator==(const ChannelStatus&, const ChannelStatus&) = default;
};

/// A number with its unit and standard error, by name.
struct Quantity {
  std::string name;
  std::string unit;
  double value = 0.0;
  bool std_error_known = false;
  double std_error = 0.0;
  SEALWATCH_FIELDS(Quantity, name, unit, value, std_error_known, std_error)
  friend bool operator==(const Quantity&, const Quantity&) = default;
};

}  // namespace sealwatch

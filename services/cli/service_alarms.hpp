// What is wrong with the services themselves, where they cannot see what they are there to see: in words, each with its
// category of NAMUR NE 107.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sealwatch/core/time.hpp"
#include "sealwatch/message/ne107.hpp"
#include "sealwatch/message/service.hpp"
#include "services/cli/services_heard.hpp"

namespace sealwatch::cli {

struct HeardAlarm {
  std::string service;
  ServiceAlarm alarm;
  std::uint64_t untold = 0;  ///< alarms of this service that did not fit into its heartbeat, said with its last one
  std::optional<AlarmEntry> entry = {};  ///< its state, where advisory generation is heard and knows it
};
/// Those that stand, service by service, then what else the alarm desk keeps: advisories, what returned unseen.
[[nodiscard]] std::vector<HeardAlarm> alarms_of(const std::vector<ServicesHeard::Service>& services);
/// Whether something is not seen now: any active alarm in view, but those that only ask for maintenance.
[[nodiscard]] bool is_blind(const std::vector<HeardAlarm>& alarms, UtcTime now);
/// Whether it says no more than the advisory of its asset.
[[nodiscard]] bool stands_in_advisory(const HeardAlarm& heard, UtcTime now);
/// Active, and set aside by nobody and by no design.
[[nodiscard]] bool is_in_view(const HeardAlarm& heard, UtcTime now);
/// What it says, broken into lines, and on a line of its own the command that answers it, to be pasted.
[[nodiscard]] std::string lines_of(const HeardAlarm& heard, UtcTime now);

}  // namespace sealwatch::cli

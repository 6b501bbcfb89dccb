// The alarms of the running services with their states, for who wants to do something about one.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/cli/service_alarms.hpp"
#include "services/cli/session.hpp"

namespace sealwatch::cli {

/// What advisory generation, which keeps the states, says of alarms.
struct AlarmsListed {
  bool heard = false;
  std::vector<AlarmEntry> entries;
  bool complete = true;    ///< all fit into its heartbeat
  std::string last_error;  ///< of advisory generation

  [[nodiscard]] const AlarmEntry* find(const std::string& asset_id, const std::string& alarm_id) const;
  /// What to tell who named one that is not there.
  [[nodiscard]] Error unknown(const std::string& asset_id, const std::string& alarm_id) const;
};

/// Listens until it was heard, or for as long as it takes to know that it is not. The bus must be subscribed to the
/// service topics. `is_enough`: until it says so, too.
[[nodiscard]] AlarmsListed listen_for_alarms(Bus& bus, const std::function<bool(const AlarmsListed&)>& is_enough = {});

}  // namespace sealwatch::cli

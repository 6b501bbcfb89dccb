#include "services/cli/status_overview.hpp"

#include <algorithm>

#include "sealwatch/message/alarm_state.hpp"
#include "services/cli/terminal.hpp"

namespace sealwatch::cli {

std::string status_overview(const std::vector<ServicesHeard::Service>& services, const std::vector<HeardAlarm>& alarms,
                            const std::map<std::string, AssetView>& assets, UtcTime now) {
  const auto expected = std::ranges::count_if(services, &ServicesHeard::Service::expected);
  const auto well = std::ranges::count_if(
      services, [](const ServicesHeard::Service& one) { return one.expected && one.trouble.empty(); });
  std::size_t active = 0, ended = 0;
  for (const HeardAlarm& alarm : alarms) {
    active += is_in_view(alarm, now) && !is_advice(alarm.alarm) ? 1 : 0;
    ended += alarm.entry && state_of(*alarm.entry, now) == AlarmState::returned ? 1 : 0;
  }
  std::string text = std::to_string(well) + " of " + std::to_string(expected) + " services well, " +
                     (active == 0 ? "no alarm" : count_of(active, "alarm")) +
                     (ended == 0 ? "" : ", " + count_of(ended, "ended alarm") + " to acknowledge") + "\n";
  bool quiet = true;
  for (const auto& [asset, view] : assets)
    if (const std::string call = view.call(); !call.empty()) {
      text.append(asset).append(": ").append(call).append("\n");
      quiet = false;
    }
  if (quiet && !assets.empty()) text += "no actuator asks for action\n";
  return text;
}

}  // namespace sealwatch::cli

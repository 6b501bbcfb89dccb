// What a service cannot mend by itself, for as long as it stands: told in its heartbeat (message/service.hpp).
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "sealwatch/message/service.hpp"

namespace sealwatch {

class Alarms {
 public:
  /// True when it did not stand before.
  bool raise(ServiceAlarm alarm) {
    for (const ServiceAlarm& standing : standing_)
      if (standing.kind == alarm.kind && standing.subject == alarm.subject) return false;
    standing_.push_back(std::move(alarm));
    return true;
  }
  void clear(const std::string& kind, const std::string& subject) {
    std::erase_if(standing_, [&](const ServiceAlarm& alarm) { return alarm.kind == kind && alarm.subject == subject; });
  }
  void tell(ServiceStatus& status) const {
    const std::size_t told = std::min(standing_.size(), kMostTold);
    status.alarms.assign(standing_.end() - static_cast<std::ptrdiff_t>(told), standing_.end());
    status.alarm_count = standing_.size();
  }

 private:
  static constexpr std::size_t kMostTold = 32;  ///< a heartbeat stays small
  std::vector<ServiceAlarm> standing_;          ///< in the order in which they were raised
};

}  // namespace sealwatch

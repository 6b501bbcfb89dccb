// What a service cannot mend by itself, for as long as it stands: told in its heartbeat (message/service.hpp).
#pragma once

#include <algorithm>
#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "sealwatch/message/ne107.hpp"
#include "sealwatch/message/service.hpp"

namespace sealwatch {

class Alarms {
 public:
  using Steady = std::chrono::nanoseconds;  ///< since some fixed moment, by a clock that nobody sets

  /// True when it did not stand before. One with an `end` stands until then, or for longer when it is raised again.
  /// Strangers choose some subjects: of one kind only so many stand, but for what is set aside, which is in the journal.
  bool raise(ServiceAlarm alarm, std::optional<Steady> end = {}) {
    for (Standing& standing : standing_)
      if (is(standing, alarm.kind, alarm.asset_id, alarm.subject)) return standing.end = end, false;
    const auto of_kind = std::ranges::count_if(
        standing_, [&](const Standing& standing) { return standing.end && standing.alarm.kind == alarm.kind; });
    if (end && of_kind >= kMostOfAKind) return false;
    const auto later =
        std::ranges::upper_bound(standing_, alarm.since_ns, {}, [](const Standing& one) { return one.alarm.since_ns; });
    standing_.insert(later, {std::move(alarm), end});  // what is recalled of the past hides nothing that is new
    return true;
  }
  /// True when it stood.
  bool clear(const std::string& kind, const std::string& asset_id, const std::string& subject) {
    return std::erase_if(standing_, [&](const Standing& one) { return is(one, kind, asset_id, subject); }) > 0;
  }
  /// Takes away those whose end has come.
  std::vector<ServiceAlarm> expire(Steady now) {
    std::vector<ServiceAlarm> over;
    for (const Standing& one : standing_)
      if (one.end && *one.end <= now) over.push_back(one.alarm);
    std::erase_if(standing_, [&](const Standing& one) { return one.end && *one.end <= now; });
    return over;
  }
  /// Those of a kind about an asset, the newest last.
  [[nodiscard]] std::vector<ServiceAlarm> of(const std::string& kind, const std::string& asset_id) const {
    std::vector<ServiceAlarm> found;
    for (const Standing& one : standing_)
      if (one.alarm.kind == kind && one.alarm.asset_id == asset_id) found.push_back(one.alarm);
    return found;
  }
  void tell(ServiceStatus& status) const {
    const std::size_t told = std::min(standing_.size(), kMostTold);
    status.alarms.clear();
    for (std::size_t i = standing_.size() - told; i < standing_.size(); ++i) {
      status.alarms.push_back(standing_[i].alarm);
      status.alarms.back().ne107 = words(category_of(standing_[i].alarm.kind));
    }
    status.alarm_count = standing_.size();
    Ne107 worst = status.state == kRestoring ? Ne107::function_check : Ne107::good;
    for (const Standing& one : standing_) worst = worse(worst, category_of(one.alarm.kind));
    status.ne107 = words(worst);
  }

 private:
  struct Standing {
    ServiceAlarm alarm;
    std::optional<Steady> end;
  };
  static bool is(const Standing& standing, const std::string& kind, const std::string& asset_id,
                 const std::string& subject) {
    const ServiceAlarm& alarm = standing.alarm;
    return alarm.kind == kind && alarm.asset_id == asset_id && alarm.subject == subject;
  }

  static constexpr std::size_t kMostTold = 32;  ///< a heartbeat stays small
  static constexpr std::ptrdiff_t kMostOfAKind = 256;
  std::vector<Standing> standing_;  ///< the newest last
};

}  // namespace sealwatch

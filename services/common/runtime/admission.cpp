#include "services/common/runtime/admission.hpp"

#include <algorithm>

namespace sealwatch {
namespace {

constexpr std::int64_t kDay_ns = 86'400'000'000'000;

bool is_report(const Message& message) {
  return topic_of(message) == Topic::maintenance_event || topic_of(message) == Topic::acknowledgement;
}

}  // namespace

void Admission::note(const Message& message) {
  const Header& header = header_of(message);
  if (is_report(message) || header.pst_id.empty() || !header.event_time_known) return;
  std::int64_t& newest = newest_ns_.try_emplace(asset_of(message), header.event_time_ns).first->second;
  newest = std::max(newest, header.event_time_ns);
}

std::optional<std::string> Admission::refusal(const Message& message, UtcTime now) const {
  const Header& header = header_of(message);
  if (topic_of(message) == Topic::maintenance_event && !header.event_time_known)
    return "its time is not known, so it cannot part a history; report it again, with the time at which it happened";
  if (!is_report(message) || !header.event_time_known) return std::nullopt;
  std::int64_t latest = now.nanoseconds;
  if (const auto newest = newest_ns_.find(asset_of(message)); newest != newest_ns_.end())
    latest = std::max(latest, newest->second);
  if (header.event_time_ns <= latest + kDay_ns) return std::nullopt;
  return "its time, " + format_utc({header.event_time_ns}) + ", lies in the future: it is now " + format_utc(now) +
         "; report it again, with the time at which it happened";
}

}  // namespace sealwatch

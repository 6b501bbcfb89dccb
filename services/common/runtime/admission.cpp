#include "services/common/runtime/admission.hpp"

#include <algorithm>

namespace sealwatch {
namespace {

constexpr std::int64_t kDay_ns = 86'400'000'000'000;
constexpr std::int64_t kYear_ns = 366 * kDay_ns;

bool is_report(const Message& message) {
  return topic_of(message) == Topic::maintenance_event || topic_of(message) == Topic::acknowledgement;
}

/// When the test was made that the message is about.
std::optional<std::int64_t> time_of_test(const Message& message) {
  if (const auto* raw = std::get_if<RawSamples>(&message))
    return raw->start_time_known ? std::optional(raw->start_time_ns) : std::nullopt;
  const Header& header = header_of(message);
  const bool known = !is_report(message) && !header.pst_id.empty() && header.event_time_known;
  return known ? std::optional(header.event_time_ns) : std::nullopt;
}

}  // namespace

void Admission::note(const Message& message) {
  const std::optional<std::int64_t> time_ns = time_of_test(message);
  if (!time_ns) return;
  std::int64_t& newest = newest_ns_.try_emplace(asset_of(message), *time_ns).first->second;
  newest = std::max(newest, *time_ns);
}

std::optional<std::string> Admission::refusal(const Message& message, UtcTime now) const {
  const Header& header = header_of(message);
  if (topic_of(message) == Topic::maintenance_event && !header.event_time_known)
    return "its time is not known, so it cannot part a history; report it again, with the time at which it happened";
  if (topic_of(message) == Topic::raw_samples) return refusal_of_test(message, now);
  if (!is_report(message) || !header.event_time_known) return std::nullopt;
  std::int64_t latest = now.nanoseconds;
  if (const auto newest = newest_ns_.find(asset_of(message)); newest != newest_ns_.end())
    latest = std::max(latest, newest->second);
  if (header.event_time_ns <= latest + kDay_ns) return std::nullopt;
  return "its time, " + format_utc({header.event_time_ns}) + ", lies in the future: it is now " + format_utc(now) +
         "; report it again, with the time at which it happened";
}

std::optional<std::string> Admission::refusal_of_test(const Message& message, UtcTime now) const {
  const auto newest = newest_ns_.find(asset_of(message));
  const std::optional<std::int64_t> time_ns = time_of_test(message);
  if (!time_ns || newest == newest_ns_.end()) return std::nullopt;
  if (*time_ns <= now.nanoseconds + kDay_ns || *time_ns <= newest->second + kYear_ns) return std::nullopt;
  const RawSamples& raw = std::get<RawSamples>(message);
  return (raw.recording_id.empty() ? "a test" : "recording " + raw.recording_id) + " of " + raw.asset_id +
         ": its start time, " + format_utc({*time_ns}) + ", lies in the future (it is now " + format_utc(now) +
         ") and more than a year after the asset's newest test, " + format_utc({newest->second}) +
         "; correct the start time, and give it again";
}

}  // namespace sealwatch

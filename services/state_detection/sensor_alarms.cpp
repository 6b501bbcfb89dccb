#include "services/state_detection/sensor_alarms.hpp"

#include <algorithm>

#include "sealwatch/message/retraction.hpp"

namespace sealwatch {
namespace {

/// What the report says of the channel, in its own words.
std::string words_about(const StateReport& report, const std::string& channel) {
  const std::string begin = "channel " + channel + ",";
  const auto& reasons = report.verdict_reasons;
  const auto found = std::ranges::find_if(reasons, [&](const std::string& one) { return one.starts_with(begin); });
  return found == reasons.end() ? "was OK in most earlier tests" : *found;
}

}  // namespace

std::optional<StandingAlarms> LostSensors::look(const Message& output) {
  const auto* report = std::get_if<StateReport>(&output);
  if (report == nullptr) return std::nullopt;
  const auto& sources = report->header.source_ids;
  const bool answers_retraction =
      report->header.pst_id.empty() && !sources.empty() && is_retraction_id(sources.front());
  if (report->header.pst_id.empty() && !answers_retraction) return std::nullopt;
  if (report->header.event_time_known) {
    std::int64_t& newest = newest_ns_.try_emplace(report->asset_id, report->header.event_time_ns).first->second;
    if (report->header.event_time_ns < newest && !answers_retraction) return std::nullopt;
    newest = report->header.event_time_ns;
  }
  StandingAlarms alarms{.kind = "sensor_lost", .asset_id = report->asset_id, .standing = {}};
  for (const std::string& channel : report->stale_channels)
    alarms.standing.push_back({.kind = alarms.kind,
                               .asset_id = report->asset_id,
                               .subject = channel,
                               .pst_id = report->header.pst_id,
                               .text = words_about(*report, channel),
                               .since_ns = report->header.event_time_known ? report->header.event_time_ns : 0});
  return alarms;
}

}  // namespace sealwatch

// What people do with alarms, besides acknowledging them (topic acknowledgement, with alarm_id() as its advisory_id). It
// travels as a maintenance_event of these kinds, with who and why; its message_id says what is meant:
//
//   alarm_shelved          alarm_act/<asset>/<when>/<end>/<alarm id>
//   alarm_unshelved        alarm_act/<asset>/<when>/<alarm id>
//   asset_out_of_service   alarm_act/<asset>/<when>
//   asset_in_service       alarm_act/<asset>/<when>
//
// <asset> is "" for an alarm about none.
#pragma once

#include <charconv>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

#include "sealwatch/core/time.hpp"
#include "sealwatch/message/advisory_generation.hpp"

namespace sealwatch {

inline constexpr std::string_view kAlarmShelved = "alarm_shelved";
inline constexpr std::string_view kAlarmUnshelved = "alarm_unshelved";
inline constexpr std::string_view kAssetOutOfService = "asset_out_of_service";
inline constexpr std::string_view kAssetInService = "asset_in_service";

struct AlarmAct {
  std::string alarm_id;          ///< "" where it is about the asset
  std::optional<UtcTime> until;  ///< end of the shelf
};

[[nodiscard]] inline bool is_alarm_act(std::string_view kind) {
  return kind == kAlarmShelved || kind == kAlarmUnshelved || kind == kAssetOutOfService || kind == kAssetInService;
}

[[nodiscard]] inline std::string alarm_act_id(const std::string& asset_id, UtcTime when, const AlarmAct& act) {
  std::string id = "alarm_act/" + asset_id + "/" + format_utc(when);
  if (act.until) id.append("/").append(format_utc(*act.until));
  if (!act.alarm_id.empty()) id.append("/").append(act.alarm_id);
  return id;
}

/// What an event of such a kind means; nothing when its id does not say it.
[[nodiscard]] inline std::optional<AlarmAct> alarm_act_of(const MaintenanceEvent& event) {
  const std::string begin = "alarm_act/" + event.asset_id + "/";
  const std::string& id = event.header.message_id;
  if (!is_alarm_act(event.kind) || !id.starts_with(begin)) return std::nullopt;
  const std::size_t end_of_time = id.find('/', begin.size());
  std::string rest = end_of_time == std::string::npos ? "" : id.substr(end_of_time + 1);
  AlarmAct act;
  if (event.kind == kAlarmShelved) {
    const std::size_t end_of_until = rest.find('/');
    const auto until = parse_utc(rest.substr(0, end_of_until));
    if (!until || end_of_until == std::string::npos) return std::nullopt;
    act.until = *until;
    rest.erase(0, end_of_until + 1);
  }
  act.alarm_id = std::move(rest);
  const bool is_about_an_alarm = event.kind == kAlarmShelved || event.kind == kAlarmUnshelved;
  return act.alarm_id.empty() == is_about_an_alarm ? std::nullopt : std::optional(act);
}

/// When it was said, by its id.
[[nodiscard]] inline std::optional<UtcTime> time_of_alarm_act(const std::string& asset_id, const std::string& act_id) {
  const std::string begin = "alarm_act/" + asset_id + "/";
  if (!act_id.starts_with(begin)) return std::nullopt;
  const auto time = parse_utc(act_id.substr(begin.size(), act_id.find('/', begin.size()) - begin.size()));
  return time ? std::optional(*time) : std::nullopt;
}

/// What the desk itself keeps beside acknowledgements, in their form and by nobody: that the alarm was over. Its id:
/// `alarm_over/ALARM_ID/NANOSECONDS`
struct AlarmOver {
  std::string alarm_id;
  UtcTime at;
};

[[nodiscard]] inline std::string alarm_over_id(const std::string& alarm_id, UtcTime at) {
  return "alarm_over/" + alarm_id + "/" + std::to_string(at.nanoseconds);
}

[[nodiscard]] inline std::optional<AlarmOver> alarm_over_of(std::string_view act_id) {
  constexpr std::string_view kBegin = "alarm_over/";
  const std::size_t end = act_id.rfind('/');
  if (!act_id.starts_with(kBegin) || end < kBegin.size()) return std::nullopt;
  AlarmOver over{.alarm_id = std::string(act_id.substr(kBegin.size(), end - kBegin.size())), .at = {}};
  const std::string_view time = act_id.substr(end + 1);
  const auto read = std::from_chars(time.data(), time.data() + time.size(), over.at.nanoseconds);
  return read.ec == std::errc() && read.ptr == time.data() + time.size() ? std::optional(over) : std::nullopt;
}

/// Whether what an acknowledgement names is an advisory; else it is an alarm, by alarm_id().
[[nodiscard]] inline bool is_advisory_id(std::string_view id) { return id.starts_with("recommendation/"); }

}  // namespace sealwatch

// The states of an alarm or advisory after ISA-18.2 and IEC 62682, from its entry (service.hpp):
//
//   unacknowledged   active, and nobody has said that it was seen
//   acknowledged     active and seen
//   returned         over, and nobody has said that it was seen: it stays in view until somebody does
//   shelved          set aside by somebody until a date, when it comes back by itself
//   suppressed       active, and by design no more than what another active alarm leads one to expect
//   out_of_service   of an asset that somebody works on, until that is taken back
//
// None of them changes anything that is concluded.
#pragma once

#include <string>
#include <string_view>

#include "sealwatch/core/time.hpp"
#include "sealwatch/message/service.hpp"

namespace sealwatch {

SEALWATCH_ENUM(AlarmState, unacknowledged, acknowledged, returned, shelved, suppressed, out_of_service)

inline constexpr std::string_view kAdviceAlarm = "advice";                ///< an advisory that asks for something
inline constexpr std::string_view kOverdueAlarm = "overdue";              ///< one that asks for an overdue test
inline constexpr std::string_view kOutOfServiceAlarm = "out_of_service";  ///< somebody works on the asset

/// Whether it is told as an advisory already.
[[nodiscard]] inline bool is_advice(const ServiceAlarm& alarm) {
  return alarm.kind == kAdviceAlarm || alarm.kind == kOverdueAlarm;
}

/// By what people name it, beside its asset: "sensor_lost/pressure_a", or the id of an advisory.
[[nodiscard]] inline std::string alarm_id(const ServiceAlarm& alarm) {
  if (is_advice(alarm)) return alarm.subject;
  return alarm.subject.empty() ? alarm.kind : alarm.kind + "/" + alarm.subject;
}

/// The shelf ends by itself at its date, whatever ran meanwhile: hence `now`.
[[nodiscard]] inline AlarmState state_of(const AlarmEntry& entry, UtcTime now) {
  if (!entry.out_of_service_by.empty()) return AlarmState::out_of_service;
  if (entry.shelved_until_ns > now.nanoseconds) return AlarmState::shelved;
  if (entry.ended_ns != 0) return AlarmState::returned;
  if (!entry.suppressed_by.empty()) return AlarmState::suppressed;
  return entry.acknowledged_by.empty() ? AlarmState::unacknowledged : AlarmState::acknowledged;
}

}  // namespace sealwatch

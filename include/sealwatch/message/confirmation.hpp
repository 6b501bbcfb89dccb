// A second person's word: unless the configuration asks for none (operator_acts.confirmed_by_second), what lowers an
// advisory by somebody's act (a replacement, a retraction, an accepted model) counts once another one has confirmed it.
// It travels as a maintenance_event of this kind, with who and when; its message_id says what is confirmed:
//
//   act_confirmed          confirmation/<asset>/<when>/<message id of the act>
//   act_rejected           the same: the act never counts. Whoever reported it may say so, too
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "sealwatch/core/time.hpp"
#include "sealwatch/message/retraction.hpp"
#include "sealwatch/message/topics.hpp"

namespace sealwatch {

inline constexpr std::string_view kActConfirmed = "act_confirmed";
inline constexpr std::string_view kActRejected = "act_rejected";

[[nodiscard]] inline std::string confirmation_id(const std::string& asset_id, const std::string& act_id, UtcTime when) {
  return "confirmation/" + asset_id + "/" + format_utc(when) + "/" + act_id;
}

/// Message id of the act that the event of this id confirms or rejects; nothing when it is no such event.
[[nodiscard]] inline std::optional<std::string> confirmed_act(const std::string& asset_id,
                                                              const std::string& message_id) {
  const std::string begin = "confirmation/" + asset_id + "/";
  if (!message_id.starts_with(begin)) return std::nullopt;
  const std::size_t end_of_time = message_id.find('/', begin.size());
  if (end_of_time == std::string::npos || end_of_time + 1 == message_id.size()) return std::nullopt;
  return message_id.substr(end_of_time + 1);
}

/// Whether it may lower an advisory: what takes such an act back does not need a second person.
[[nodiscard]] inline bool may_lower_an_advisory(const Message& message) {
  if (const auto* event = std::get_if<MaintenanceEvent>(&message))
    return is_replacement(*event) || event->kind == kTestRetracted || event->kind == kTestsRetracted;
  const auto* acceptance = std::get_if<ModelAcceptance>(&message);
  return acceptance != nullptr && !acceptance->revoked;
}

}  // namespace sealwatch

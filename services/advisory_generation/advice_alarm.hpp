// An advisory that asks for something, as an alarm (message/alarm_state.hpp).
#pragma once

#include <optional>

#include "sealwatch/port/standing_alarms.hpp"

namespace sealwatch::advisory_generation {

/// What an advisory asks for; nothing of one that is superseded, and of any other message.
[[nodiscard]] std::optional<StandingAdvice> advice_alarm(const Message& output);

}  // namespace sealwatch::advisory_generation

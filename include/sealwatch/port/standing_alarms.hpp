// What a layer's outputs say of alarms: those of one kind about an asset, as they stand by the newest output.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "sealwatch/message/service.hpp"
#include "sealwatch/message/topics.hpp"

namespace sealwatch {

/// All alarms of one kind about an asset that stand by a conclusion: those that it does not name are over.
struct StandingAlarms {
  std::string kind;                    ///< ServiceAlarm::kind of each
  std::string asset_id;                ///< ServiceAlarm::asset_id of each
  std::vector<ServiceAlarm> standing;  ///< told apart by their subject
};

/// Called with every output of a layer in the order of conclusion, also those of its past; nothing where the output says
/// nothing about alarms.
using AlarmsOfOutput = std::function<std::optional<StandingAlarms>(const Message& output)>;

/// What the newest advisory of an asset asks for.
struct StandingAdvice {
  std::string asset_id;
  std::optional<AlarmEntry> advice;  ///< nothing where it asks for nothing
  bool is_answered = false;          ///< it asks for nothing because of what somebody did
};

/// Likewise, of advisories.
using AdviceOfOutput = std::function<std::optional<StandingAdvice>(const Message& output)>;

}  // namespace sealwatch

// What people tell the services, as the audit trail keeps it.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "sealwatch/message/topics.hpp"
#include "services/common/store/audit_trail.hpp"

namespace sealwatch {

[[nodiscard]] bool is_an_act(const Message& message);

/// Nothing for what no person said.
[[nodiscard]] std::optional<OperatorAct> act_of(const Message& message, UtcTime received, std::string outcome);

/// The outcome of an act that counts; where it is fetched back, more follows.
inline constexpr const char* kTaken = "taken";
/// Of an accepted model that counts for nothing yet (Layer::waiting).
inline constexpr const char* kTakenAndWaits = "taken, and waits until a service has published what it accepts";
[[nodiscard]] bool is_taken(std::string_view outcome);

/// Outcomes of acts that may come to count, and what follows where a neighbour's record of one was taken.
inline constexpr const char* kWaits = "waits for a second person";
inline constexpr const char* kAhead = "waits until what it means is known here";
inline constexpr const char* kFetchedBack = ", fetched back from ";
inline constexpr const char* kAsElsewhere = ", as it did at ";
[[nodiscard]] bool is_said_here(std::string_view outcome);

/// The kind of an entry that tells how many refused acts have none of their own.
inline constexpr const char* kRefusedActs = "refused_acts";

}  // namespace sealwatch

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
[[nodiscard]] bool is_taken(std::string_view outcome);

}  // namespace sealwatch

// What people tell the services, as the audit trail keeps it.
#pragma once

#include <optional>
#include <string>

#include "sealwatch/message/topics.hpp"
#include "services/common/store/audit_trail.hpp"

namespace sealwatch {

/// Nothing for what no person said.
[[nodiscard]] std::optional<OperatorAct> act_of(const Message& message, UtcTime received, std::string outcome);

}  // namespace sealwatch

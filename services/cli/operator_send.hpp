// How what people tell the system reaches it: as a stream of one message, which every reader confirms.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "services/cli/session.hpp"

namespace sealwatch::cli {

[[nodiscard]] std::int64_t now_ns();

/// In place of an asset, where an alarm is about none.
inline constexpr const char* kNoAsset = "-";

/// Every layer that reads topic maintenance_event. A report that one of them missed would count in some layers only,
/// and its confirmation would be refused there.
inline const std::vector<std::string> kReadersOfMaintenance = {"data_acquisition", "state_detection",
                                                               "prognostic_assessment", "advisory_generation"};

/// The bus, where somebody speaks of an asset that there is; else what is wrong is said on standard error.
[[nodiscard]] std::optional<Session> open_for(const std::string& config, const std::string& asset_id,
                                              const std::string& who);

/// Publishes one message as a stream of its own and waits until every one of `readers` has journaled it, and says on
/// standard error who refused it and why. What else comes on the bus meanwhile goes to `look`. Returns the exit status.
[[nodiscard]] int send(std::optional<Session>& session, Message message, std::vector<std::string> readers,
                       const std::function<void(const Message&)>& look = {});

/// Says so where an act counts only once another person confirms it. False where it counts by itself.
bool says_that_it_waits(const Session& session, const Message& act);

}  // namespace sealwatch::cli

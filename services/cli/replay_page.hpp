// The page that a replay writes at its end: the forecast of each asset that was replayed.
#pragma once

#include <map>
#include <string>

#include "services/cli/commands.hpp"
#include "services/cli/concluded_history.hpp"

namespace sealwatch::cli {

using Histories = std::map<std::string, ConcludedHistory>;  ///< by asset id

/// Writes options.page; returns the exit status and says what is wrong.
[[nodiscard]] int write_replay_page(const ReplayOptions& options, const Configuration& configuration,
                                    const Histories& replayed_here);

}  // namespace sealwatch::cli

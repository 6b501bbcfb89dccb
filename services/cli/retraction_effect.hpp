// What an act of `sealwatch retract` means, before it is sent, and whether it changed anything, after it: by what the
// services tell on the bus, and by their journals where these lie on this machine.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>

#include "services/cli/commands.hpp"
#include "services/cli/session.hpp"

namespace sealwatch::cli {

struct KnownTests {
  bool complete = false;  ///< all are known: the journals are those of the services that run
  std::map<std::string, std::optional<UtcTime>> tests = {};  ///< by PST id
  std::set<std::string> in_force = {};                       ///< ids of retractions and replacements
  std::optional<RemainingLife> life = {};                    ///< the last on the bus
};

/// Listens for about the time of a heartbeat, and reads the journals.
[[nodiscard]] KnownTests known_tests(Session& session, const RetractOptions& options);

/// Why the act means nothing: a test that is none of the asset, a date without tests since, nothing to withdraw.
[[nodiscard]] std::optional<Error> objection(const KnownTests& known, const RetractOptions& options);

/// A life that prognosis publishes while the act is sent: the answer to it, or what stood last before the answer. What
/// was heard first may be older, sent again to a reader that missed it; the last word follows it.
void hear(const RemainingLife& life, const std::string& act_id, KnownTests& known,
          std::optional<RemainingLife>& answer);

/// The same, after prognosis answered it: it concludes from the same tests as before. Nothing where that cannot be told.
[[nodiscard]] std::optional<Error> objection(const KnownTests& known, const RemainingLife& answer,
                                             const RetractOptions& options);

}  // namespace sealwatch::cli

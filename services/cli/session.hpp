// What every live command needs: the validated configuration, the bus, a way to be interrupted.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sealwatch/config/configuration.hpp"
#include "sealwatch/port/bus.hpp"
#include "services/common/runtime/process_end.hpp"

namespace sealwatch::cli {

/// The configuration at `path`; its faults are listed on standard error.
[[nodiscard]] std::optional<Configuration> load_or_explain(const std::string& path);

/// The asset file at `path`, with the channel map of `map_file` in place of its own where one is given; faults are listed
/// on standard error.
[[nodiscard]] std::optional<AssetConfig> load_asset_or_explain(const std::string& path,
                                                               const std::string& map_file = {});

/// The same, where its plant is known too: find_plant(asset.model) succeeds.
[[nodiscard]] std::optional<AssetConfig> load_asset_of_known_plant(const std::string& path,
                                                                   const std::string& map_file = {});

struct Session {
  Configuration configuration;
  std::unique_ptr<Bus> bus;
};

/// Loads the configuration and joins the bus; says on standard error what went wrong.
[[nodiscard]] std::optional<Session> open_session(const std::string& config);

/// The services of `wanted` that run in the session's domain already, in words: "state_detection (process 4711)"; ""
/// when there are none. Listens for a heartbeat's time.
[[nodiscard]] std::string running_services(Session& session, const std::vector<std::string>& wanted);

/// Whether none of `wanted` runs already; says on standard error which do, and what to do.
[[nodiscard]] bool free_to_start(Session& session, const std::vector<std::string>& wanted);

/// "sealwatch: " and the error, on standard error.
void complain(const Error& error);

/// The exit status of a command whose exit status would be that; bad where not all of its standard output was taken, as
/// of a full disk.
[[nodiscard]] int with_output_written(int status);

/// Makes Ctrl-C and SIGTERM set interrupted() instead of ending the program at once: it has so long to end by itself.
void catch_interrupts(std::chrono::milliseconds patience = kCommandStops);
[[nodiscard]] bool interrupted();

/// A name for this run of a command that no other run has: "replay-4f21c09a".
[[nodiscard]] std::string unique_name(const std::string& command);

}  // namespace sealwatch::cli

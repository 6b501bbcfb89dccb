// Starts the services as child processes, restarts one that ends, stops them all: what systemd does on a Master Control
// System, for a desk.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "sealwatch/config/configuration.hpp"
#include "sealwatch/core/result.hpp"
#include "services/common/runtime/service_manager.hpp"

namespace sealwatch::cli {

/// Path of another program of sealwatch: beside this one (a build tree, an installation), else what PATH finds.
[[nodiscard]] std::string program_path(const std::string& program);

struct ServiceProgram {
  std::string name;                    ///< "state_detection"
  std::vector<std::string> arguments;  ///< argv, the program's path first
  std::string dds_settings = {};       ///< its CYCLONEDDS_URI; "": that of this process
};

/// CYCLONEDDS_URI of `name`, the service or role, among the identities of deploy/security/make_identities.sh; an Error
/// where it is not there.
[[nodiscard]] Result<std::string> identity_settings(const std::string& directory, const std::string& name);

/// The programs of the services that `configuration`, read from the file or directory `config`, enables; found beside
/// this program or in PATH. `state_directory` instead of the configuration's unless it is "".
[[nodiscard]] std::vector<ServiceProgram> service_programs(const std::string& config,
                                                           const std::string& state_directory,
                                                           const Configuration& configuration = {});
[[nodiscard]] std::vector<std::string> names_of(const std::vector<ServiceProgram>& programs);
/// Whether this machine is to run the service: `services.NAME.enabled`, true where nothing is said.
[[nodiscard]] bool enabled(const Configuration& configuration, const std::string& service);
/// "services.state_detection disabled here ...": what a chain that stands still may lack; "" where all are enabled.
[[nodiscard]] std::string explain_disabled(const Configuration& configuration);

/// Of two that are started at once neither hears the other's services: each would take the journals of some. An Error
/// where another has it. Why a lock cannot be made otherwise is the services' to tell, and to try again: then none.
[[nodiscard]] Result<std::optional<InstanceLock>> take_supervisor_lock(const std::string& state_directory,
                                                                       const Configuration& configuration);

class Supervisor {
 public:
  /// A program that ends is started again, at the earliest `restart_pause` after its last start.
  explicit Supervisor(std::vector<ServiceProgram> programs,
                      std::chrono::milliseconds restart_pause = std::chrono::seconds(1));
  /// Stops what still runs.
  ~Supervisor();
  Supervisor(const Supervisor&) = delete;
  Supervisor& operator=(const Supervisor&) = delete;

  [[nodiscard]] Status start();
  /// Restarts programs that ended; returns what happened, in words.
  [[nodiscard]] std::vector<std::string> tend();
  /// Asks all to end (SIGTERM), waits until each has had time to, then kills. Idempotent.
  void stop();
  [[nodiscard]] pid_t process_of(const std::string& name) const;
  /// Whether a program ended at its first start because of bad input (exit status 2: its state directory cannot be
  /// written, or another one works in it). It is not started again: that would end the same way for ever.
  [[nodiscard]] bool refused() const;

 private:
  struct Child {
    ServiceProgram program;
    pid_t process = -1;
    std::chrono::steady_clock::time_point started;
    int starts = 0;
    bool refused = false;
  };
  [[nodiscard]] static Status launch(Child& child);
  std::vector<Child> children_;
  std::chrono::milliseconds restart_pause_;
};

}  // namespace sealwatch::cli

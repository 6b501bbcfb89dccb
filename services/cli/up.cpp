// `sealwatch up`: the six services on this machine, restarted when one ends.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "services/cli/commands.hpp"
#include "services/cli/session.hpp"
#include "services/cli/supervisor.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::cli {
namespace {

/// A service beats as soon as its past is restored; on a busy machine that may take some seconds.
constexpr std::chrono::seconds kPatience{15};

/// Says once all services beat that sealwatch is up, and after a while which of them do not.
class Startup {
 public:
  Startup(std::optional<Session>& session, std::vector<std::string> services)
      : session_(session), silent_(std::move(services)) {}

  /// Listens for a tenth of a second.
  void listen(const Supervisor& supervisor) {
    for (const BusItem& item : session_->bus->receive(std::chrono::milliseconds(100)))
      if (const auto* status = std::get_if<ServiceStatus>(&item))
        if (status->process_id == supervisor.process_of(status->service)) std::erase(silent_, status->service);
    if (silent_.empty()) return is_up();
    if (complained_ || std::chrono::steady_clock::now() < begin_ + kPatience) return;
    complained_ = true;
    std::string names;
    for (const std::string& name : silent_) text::add_to_list(names, name);
    std::fprintf(stderr, "sealwatch: not all services run: no heartbeat from %s within %d s\n", names.c_str(),
                 static_cast<int>(kPatience.count()));
  }

 private:
  void is_up() {
    std::printf("sealwatch is up; `sealwatch status` in another terminal shows more; Ctrl-C stops it\n");
    std::fflush(stdout);
    session_.reset();
  }

  std::optional<Session>& session_;  ///< gone once it is not needed any more
  std::vector<std::string> silent_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  bool complained_ = false;
};

/// Each service takes its own identity; `up` itself only listens.
Status take_identities(const std::string& directory, std::vector<ServiceProgram>& programs) {
  for (ServiceProgram& program : programs) {
    Result<std::string> settings = identity_settings(directory, program.name);
    if (!settings) return fail(settings.error());
    program.dds_settings = std::move(*settings);
  }
  return {};
}

Status listen_as_subscriber(const std::string& directory) {
  const Result<std::string> settings = identity_settings(directory, "subscriber");
  if (!settings) return fail(settings.error());
  ::setenv("CYCLONEDDS_URI", settings->c_str(), 1);
  return {};
}

}  // namespace

int run_up(const UpOptions& options) {
  if (!options.security.empty())
    if (const Status own = listen_as_subscriber(options.security); !own) {
      complain(own.error());
      return kBadInput;
    }
  std::optional<Session> session = open_session(options.config);
  if (!session) return kBadInput;
  std::vector<ServiceProgram> programs =
      service_programs(options.config, options.state_directory, session->configuration);
  if (!options.security.empty())
    if (const Status taken = take_identities(options.security, programs); !taken) {
      complain(taken.error());
      return kBadInput;
    }
  catch_interrupts(kSupervisorStops);
  if (!free_to_start(*session, names_of(programs))) return kBadInput;
  const auto alone = take_supervisor_lock(options.state_directory, session->configuration);
  if (!alone) {
    complain(alone.error());
    return kBadInput;
  }
  if (session->configuration.assets.empty())
    std::fprintf(stderr, "sealwatch: %s: no asset is configured: every recording will be passed over\n",
                 options.config.c_str());
  Supervisor supervisor(programs);
  if (const Status started = supervisor.start(); !started) {
    complain(started.error());
    return kInternalFailure;
  }
  for (const ServiceProgram& program : programs)
    std::printf("started %s, pid %d\n", program.name.c_str(), static_cast<int>(supervisor.process_of(program.name)));
  std::fflush(stdout);
  Startup startup(session, names_of(programs));
  while (!interrupted() && !supervisor.refused()) {
    for (const std::string& event : supervisor.tend()) std::fprintf(stderr, "%s\n", event.c_str());
    if (session)
      startup.listen(supervisor);
    else
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  const bool refused = supervisor.refused();
  supervisor.stop();
  std::printf("all services stopped%s\n", refused ? ": one could not start, the reason is above" : "");
  return refused ? kBadInput : kOk;
}

}  // namespace sealwatch::cli

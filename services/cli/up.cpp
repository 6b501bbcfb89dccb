// `sealwatch up`: the six services on this machine, restarted when one ends.
#include <chrono>
#include <cstdio>
#include <thread>

#include "services/cli/commands.hpp"
#include "services/cli/session.hpp"
#include "services/cli/supervisor.hpp"

namespace sealwatch::cli {

int run_up(const UpOptions& options) {
  std::optional<Session> session = open_session(options.config);
  if (!session) return kBadInput;
  const std::vector<ServiceProgram> programs =
      service_programs(options.config, options.state_directory, session->configuration);
  catch_interrupts();
  if (!free_to_start(*session, names_of(programs))) return kBadInput;
  if (session->configuration.assets.empty())
    std::fprintf(stderr, "sealwatch: %s: no asset is configured: every recording will be passed over\n",
                 options.config.c_str());
  session.reset();
  Supervisor supervisor(programs);
  if (const Status started = supervisor.start(); !started) {
    complain(started.error());
    return kInternalFailure;
  }
  for (const ServiceProgram& program : programs)
    std::printf("started %s, pid %d\n", program.name.c_str(), static_cast<int>(supervisor.process_of(program.name)));
  std::printf("sealwatch is up; `sealwatch status` in another terminal shows more; Ctrl-C stops it\n");
  std::fflush(stdout);
  while (!interrupted() && !supervisor.refused()) {
    for (const std::string& event : supervisor.tend()) std::fprintf(stderr, "%s\n", event.c_str());
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  const bool refused = supervisor.refused();
  supervisor.stop();
  std::printf("all services stopped%s\n", refused ? ": one could not start, the reason is above" : "");
  return refused ? kBadInput : kOk;
}

}  // namespace sealwatch::cli

#include "services/common/runtime/daemon.hpp"

#include <malloc.h>
#include <pthread.h>
#include <signal.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <cstdlib>
#include <iostream>
#include <optional>
#include <thread>

#include "services/common/runtime/configuration_loader.hpp"
#include "services/common/runtime/layer_runner.hpp"
#include "services/common/runtime/log.hpp"
#include "services/common/runtime/service_manager.hpp"
#include "services/common/runtime/system_clock.hpp"

namespace sealwatch {
namespace {

constexpr const char* kVersion = SEALWATCH_VERSION;

constexpr int kOk = 0;
constexpr int kBadUsage = 2;
constexpr int kInternalFailure = 3;

/// A main thread that has computed for longer than this hangs: the watchdog is no longer fed. The longest honest
/// computation, the estimates of one test, takes seconds.
constexpr std::chrono::milliseconds kHangs{120'000};

struct Arguments {
  std::string config = "config";
  ConfigurationOverrides overrides;
};

/// What the command line says, or the exit status when there is nothing to run.
tl::expected<Arguments, int> parse(int argc, const char* const* argv, const std::string& service) {
  Arguments arguments;
  CLI::App app("sealwatch service " + service + ": one layer of ISO 13374, run by systemd or `sealwatch up`");
  app.set_version_flag("--version", std::string("sealwatch ") + kVersion);
  app.add_option("--config", arguments.config, "sealwatch.yaml or the directory that holds it")
      ->envname("SEALWATCH_CONFIG")
      ->capture_default_str();
  app.add_option("--state", arguments.overrides.state_directory, "state directory instead of the configuration's");
  app.add_option("--domain", arguments.overrides.domain, "DDS domain instead of the configuration's")
      ->check(CLI::Range(0, 232));
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return tl::unexpected(app.exit(error) == 0 ? kOk : kBadUsage);
  }
  return arguments;
}

int complain(const std::string& service, const Error& error, int exit_status) {
  std::cerr << "sealwatch " << service << ": " << error.describe() << "\n";
  log_event(LogLevel::error, "gave up", {{"error", error.describe()}});
  return exit_status;
}

sigset_t stop_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  return signals;
}

/// Waits for SIGTERM or SIGINT in a thread of its own, so that a stop may take locks and wake the bus. The signals must
/// have been blocked before any thread was started.
class StopListener {
 public:
  explicit StopListener(std::function<void()> on_stop) {
    thread_ = std::thread([on_stop = std::move(on_stop)] {
      const sigset_t signals = stop_signals();
      int signal = 0;
      sigwait(&signals, &signal);
      on_stop();
    });
  }
  ~StopListener() {
    pthread_kill(thread_.native_handle(), SIGTERM);
    thread_.join();
  }
  StopListener(const StopListener&) = delete;
  StopListener& operator=(const StopListener&) = delete;

 private:
  std::thread thread_;
};

/// Started by `sealwatch up`: when that dies, whatever way, nobody would start this service again or stop it.
void end_with_supervisor() {
  const char* const supervisor = std::getenv(kSupervisor);
  if (supervisor == nullptr) return;
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (std::to_string(::getppid()) != supervisor) ::kill(::getpid(), SIGTERM);  // it is dead already
}

RunnerOptions runner_options(const DaemonParts& parts, const Configuration& configuration) {
  RunnerOptions options;
  options.version = kVersion;
  if (parts.make_local_inputs) options.local_inputs = parts.make_local_inputs(configuration);
  options.heartbeat.on_beat = [](std::chrono::milliseconds since_main_thread) {
    if (since_main_thread < kHangs) notify_service_manager("WATCHDOG=1");
  };
  return options;
}

/// Everything from the bus on; the configuration is valid, the lock is held.
Status serve(const DaemonParts& parts, const Configuration& configuration) {
  const SystemClock clock;
  auto journal = Journal::open(configuration.services.at(parts.service).journal, parts.service);
  if (!journal) return fail(journal.error());
  auto bus = parts.make_bus(configuration);
  if (!bus) return fail(bus.error());
  auto heartbeat_bus = parts.make_bus(configuration);
  if (!heartbeat_bus) return fail(heartbeat_bus.error());
  const std::unique_ptr<Layer> layer = parts.make_layer(configuration, clock);
  LayerRunner runner(*layer, **bus, **heartbeat_bus, *journal, clock, runner_options(parts, configuration));
  std::atomic<bool> stop{false};
  const StopListener listener([&stop, &bus = **bus] {
    stop = true;
    bus.wake();
  });
  if (const Status started = runner.start(); !started) return started;
  ::malloc_trim(0);  // restoring the past took memory that is not needed again
  notify_service_manager("READY=1");
  const Status ran = runner.run(stop);
  notify_service_manager("STOPPING=1");
  return ran;
}

int run(const Arguments& arguments, const DaemonParts& parts) {
  const Checked<Configuration> configuration = load_configuration(arguments.config, arguments.overrides);
  if (!configuration) {
    for (const Error& error : configuration.error()) complain(parts.service, error, kBadUsage);
    return kBadUsage;
  }
  if (const Status logging = start_logging(configuration->logging, parts.service); !logging)
    return complain(parts.service, logging.error(), kBadUsage);
  const auto lock = InstanceLock::take(configuration->state_directory, parts.service);
  if (!lock) return complain(parts.service, lock.error(), kBadUsage);
  const sigset_t signals = stop_signals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  end_with_supervisor();
  if (const Status served = serve(parts, *configuration); !served)
    return complain(parts.service, served.error(), kInternalFailure);
  log_event(LogLevel::info, "stopped");
  return kOk;
}

}  // namespace

int run_daemon(int argc, const char* const* argv, const DaemonParts& parts) {
  const auto arguments = parse(argc, argv, parts.service);
  if (!arguments) return arguments.error();
  int status = kInternalFailure;
  try {
    status = run(*arguments, parts);
  } catch (const std::exception& exception) {
    complain(parts.service, Error{{}, {}, {}, exception.what(), "this is a fault of the program: report it"},
             kInternalFailure);
  }
  stop_logging();
  return status;
}

}  // namespace sealwatch

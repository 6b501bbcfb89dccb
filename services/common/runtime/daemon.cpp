#include "services/common/runtime/daemon.hpp"

#include <fcntl.h>
#include <malloc.h>
#include <pthread.h>
#include <signal.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <mutex>
#include <optional>
#include <thread>

#include "sealwatch/core/visible_text.hpp"
#include "services/common/runtime/configuration_loader.hpp"
#include "services/common/runtime/large_blocks.hpp"
#include "services/common/runtime/layer_runner.hpp"
#include "services/common/runtime/log.hpp"
#include "services/common/runtime/process_end.hpp"
#include "services/common/runtime/service_manager.hpp"
#include "services/common/runtime/system_clock.hpp"

namespace sealwatch {
namespace {

constexpr const char* kVersion = SEALWATCH_VERSION;

constexpr int kOk = 0;
constexpr int kBadUsage = 2;
constexpr int kInternalFailure = 3;

/// A main thread that has stored for longer than this hangs: the watchdog is no longer fed. What computes, the threads
/// of the lanes, it looks after itself.
constexpr std::chrono::milliseconds kHangs{60'000};
/// What still computes so long after a stop is cut: it is done again from the journal.
constexpr std::chrono::milliseconds kPatienceAtEnd{100};

/// What computes with several threads, or waits for a busy processor, takes so many times its deadline by the clock.
constexpr int kByTheClock = 5;

struct Arguments {
  std::string config = "config";
  ConfigurationOverrides overrides;
};

/// What the command line says, or the exit status when there is nothing to run.
tl::expected<Arguments, int> parse(int argc, const char* const* argv, const DaemonParts& parts) {
  Arguments arguments;
  CLI::App app("sealwatch service " + parts.service + ": one layer of ISO 13374, run by systemd or `sealwatch up`");
  app.set_version_flag("--version", parts.version_line);
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
  std::cerr << "sealwatch " << service << ": " << visible(error.describe()) << "\n";
  log_event(LogLevel::error, "gave up", {{"error", error.describe()}});
  return exit_status;
}

/// On a full disk a service ends as it does when it cannot write its journal: it is started again until it can.
int cannot_begin(const std::string& service, const Error& error) {
  return complain(service, error, is_for_want_of_space(error) ? kInternalFailure : kBadUsage);
}

/// Ends the process though something in it still computes and cannot be stopped; all that counts is in the journal.
[[noreturn]] void end_now(const std::string& service, const Status& served) {
  const int status = served ? kOk : complain(service, served.error(), kInternalFailure);
  if (served) log_event(LogLevel::info, "stopped");
  ::_exit(status);  // the log, which every such line reaches at once, stays open: what computes may tell it something
}

/// To the thread that waits for a stop, when there is none to wait for any longer. SIGTERM would do, and end the whole
/// process should that thread ever not hold it back.
constexpr int kWaitIsOver = SIGUSR1;

sigset_t stop_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGTERM, SIGINT, kWaitIsOver}) sigaddset(&signals, signal);
  return signals;
}

/// Waits for SIGTERM or SIGINT in a thread of its own, so that a stop may take locks and wake the bus. The signals must
/// have been blocked before any thread was started. What has not stopped then (an endless computation, a past that takes
/// long to restore, a database that does not answer) is ended: the journal has all that was concluded.
class StopListener {
 public:
  StopListener() {
    prepare_process_end();
    thread_ = std::thread([this] {
      const sigset_t signals = stop_signals();
      int signal = kWaitIsOver;
      while (signal == kWaitIsOver && !over_) sigwait(&signals, &signal);  // from outside it means nothing
      if (over_) return;
      end_process_in(kServiceStops, kOk);
      const std::lock_guard lock(mutex_);
      stop_ = true;
      if (bus_ != nullptr) bus_->wake();
    });
  }
  ~StopListener() {
    over_ = true;
    pthread_kill(thread_.native_handle(), kWaitIsOver);
    thread_.join();
  }
  StopListener(const StopListener&) = delete;
  StopListener& operator=(const StopListener&) = delete;

  /// Who waits on `bus` is woken at a stop; nullptr before the bus ends.
  void wake_at_stop(Bus* bus) {
    const std::lock_guard lock(mutex_);
    bus_ = bus;
  }
  [[nodiscard]] const std::atomic<bool>& stop() const { return stop_; }

 private:
  std::mutex mutex_;
  Bus* bus_ = nullptr;
  std::atomic<bool> stop_{false};
  std::atomic<bool> over_{false};
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
  options.build = parts.version_line;
  options.commissioned = configuration.commissioned;
  options.watches_clock = parts.service == "data_acquisition";  // where tests get their time; six would say the same
  options.read_clock = read_clock;
  options.retention = configuration.retention;
  options.strangers = {.services = service_names(), .senders = configuration.senders};
  options.strangers.refuses_unknown = configuration.refuses_unknown_writers;
  options.refuses_unknown_assets = configuration.refuses_unknown_assets;
  options.acts_confirmed_by_second = configuration.acts_confirmed_by_second;
  options.refused_by_bus = parts.refused_by_bus;
  if (parts.make_alarms_of_output) options.alarms_of_output = parts.make_alarms_of_output();
  if (parts.keeps_alarms) {
    options.desk = AlarmDesk::Options{.service = parts.service, .services = {}};
    for (const std::string& service : service_names())
      if (configuration.services.at(service).enabled) options.desk->services.push_back(service);
  }
  options.advice_of_output = parts.advice_of_output;
  if (parts.make_local_inputs) options.local_inputs = parts.make_local_inputs(configuration);
  for (const AssetConfig& asset : configuration.assets) options.assets.push_back(asset.asset_id);
  const std::chrono::duration<double> deadline(configuration.services.at(parts.service).deadline_s);
  Workers::Limits& workers = options.lanes.workers;
  workers.deadline = std::chrono::round<std::chrono::milliseconds>(deadline);
  workers.by_clock = std::max(workers.by_clock, kByTheClock * workers.deadline);
  options.lanes.try_record =
      (std::filesystem::path(configuration.state_directory) / (parts.service + ".tries")).string();
  options.heartbeat.on_beat = [](std::chrono::milliseconds since_main_thread) {
    if (since_main_thread < kHangs) notify_service_manager("WATCHDOG=1");
  };
  return options;
}

LayerMaker layer_maker(const DaemonParts& parts, const Configuration& configuration, const Clock& clock) {
  return [&parts, of_asset = configurations_of_assets(configuration), &clock](const std::string& asset_id) {
    return parts.make_layer(of_asset(asset_id), clock);
  };
}

/// Everything from the bus on; the configuration is valid, the lock is held.
Status serve(const DaemonParts& parts, const Configuration& configuration) {
  StopListener listener;
  const SystemClock clock;
  auto journal = Journal::open(configuration.services.at(parts.service).journal, parts.service);
  if (!journal) return fail(journal.error());
  auto bus = parts.make_bus(configuration);
  if (!bus) return fail(bus.error());
  auto heartbeat_bus = parts.make_bus(configuration);
  if (!heartbeat_bus) return fail(heartbeat_bus.error());
  LayerRunner runner(layer_maker(parts, configuration, clock), **bus, **heartbeat_bus, *journal, clock,
                     runner_options(parts, configuration));
  listener.wake_at_stop(bus->get());
  const auto bus_ends = std::shared_ptr<void>(nullptr, [&](void*) { listener.wake_at_stop(nullptr); });
  if (Status started = runner.start(); !started) return started;
  ::malloc_trim(0);  // restoring the past took memory that is not needed again
  notify_service_manager("READY=1");
  Status ran = runner.run(listener.stop());
  notify_service_manager("STOPPING=1");
  if (!runner.stop(kPatienceAtEnd)) end_now(parts.service, ran);
  return ran;
}

int run(const Arguments& arguments, const DaemonParts& parts) {
  const Checked<Configuration> configuration = load_configuration(arguments.config, arguments.overrides);
  if (!configuration) {
    for (const Error& error : configuration.error()) complain(parts.service, error, kBadUsage);
    return kBadUsage;
  }
  if (const Status logging = start_logging(configuration->logging, parts.service); !logging)
    return cannot_begin(parts.service, logging.error());
  const auto lock = InstanceLock::take(configuration->state_directory, parts.service);
  if (!lock) return cannot_begin(parts.service, lock.error());
  ::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is an error with a name, as is a full disk
  const sigset_t signals = stop_signals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  end_with_supervisor();
  if (const Status served = serve(parts, *configuration); !served)
    return complain(parts.service, served.error(), kInternalFailure);
  log_event(LogLevel::info, "stopped");
  return kOk;
}

/// Whoever starts a service without them has the first files that it opens in their place: its warnings, and those of
/// libraries, would go into a lock or the log.
void open_standard_streams() {
  int opened = -1;
  do {
    opened = ::open("/dev/null", O_RDWR);
  } while (opened >= 0 && opened <= STDERR_FILENO);
  if (opened >= 0) ::close(opened);
}

}  // namespace

int run_daemon(int argc, const char* const* argv, const DaemonParts& parts) {
  open_standard_streams();
  give_large_blocks_back();
  const auto arguments = parse(argc, argv, parts);
  if (!arguments) return arguments.error();
  int status = kInternalFailure;
  try {
    status = run(*arguments, parts);
  } catch (const std::exception& exception) {
    complain(parts.service, Error{{}, {}, {}, exception.what(), "this is a fault of the program: report it"},
             kInternalFailure);
  }
  stop_logging();
  keep_process();
  return status;
}

}  // namespace sealwatch

#include "services/virtual_bench/run_bench.hpp"

#include <CLI/CLI.hpp>
#include <csignal>
#include <exception>
#include <iostream>

#include "services/common/core/build_version.hpp"
#include "services/common/runtime/configuration_loader.hpp"
#include "services/common/runtime/log.hpp"
#include "services/common/runtime/process_end.hpp"
#include "services/common/runtime/service_manager.hpp"
#include "services/common/runtime/system_clock.hpp"
#include "services/virtual_bench/bench_service.hpp"

namespace sealwatch::bench {
namespace {

constexpr int kOk = 0;
constexpr int kBadUsage = 2;
constexpr int kInternalFailure = 3;
constexpr std::chrono::milliseconds kPause{100};  // between two looks at the time, and at a stop

volatile std::sig_atomic_t stop = 0;

struct Arguments {
  std::string config = "config";
  ConfigurationOverrides overrides;
  double acceleration = 1.0;
  std::string start;
  ActuatorSetting actuator;
};

tl::expected<Arguments, int> parse(int argc, const char* const* argv) {
  Arguments out;
  CLI::App app("sealwatch virtual bench: simulated actuators that send their tests on the bus");
  app.set_version_flag("--version", version_line());
  app.add_option("--config", out.config, "sealwatch.yaml or the directory that holds it")
      ->envname("SEALWATCH_CONFIG")
      ->capture_default_str();
  app.add_option("--domain", out.overrides.domain, "DDS domain instead of the configuration's")
      ->check(CLI::Range(0, 232));
  app.add_option("--acceleration", out.acceleration, "how much faster than the clock time passes")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--start", out.start, "date at which the actuators are installed and time starts (default: now)");
  app.add_option("--seed", out.actuator.seed, "of everything random")->capture_default_str();
  app.add_option("--rate", out.actuator.test.sample_rate_Hz, "samples a second")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--commands-per-month", out.actuator.commands_per_month,
                 "how often the control system moves a valve by itself")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return tl::unexpected(app.exit(error) == 0 ? kOk : kBadUsage);
  }
  return out;
}

int complain(const Error& error, int exit_status) {
  std::cerr << "sealwatch virtual_bench: " << error.describe() << "\n";
  return exit_status;
}

Status serve(Bus& bus, const Clock& clock, const Configuration& configuration, const ActuatorSetting& setting) {
  BenchService service(bus, clock, configuration.assets, setting);
  if (Status started = service.start(); !started) return started;
  notify_service_manager("READY=1");
  log_event(LogLevel::info, "started",
            {{"actuators", std::to_string(service.actuators().size())}, {"time", format_utc(clock.now())}});
  while (stop == 0)
    if (Status stepped = service.step(kPause); !stepped) return stepped;
  notify_service_manager("STOPPING=1");
  return {};
}

int run(Arguments& arguments, const BusMaker& make_bus) {
  const Checked<Configuration> configuration = load_configuration(arguments.config, arguments.overrides);
  if (!configuration) return complain(combine(configuration.error()), kBadUsage);
  const SystemClock real;
  const Result<UtcTime> start = arguments.start.empty() ? real.now() : parse_utc(arguments.start);
  if (!start) return complain(start.error(), kBadUsage);
  if (const Status logging = start_logging(configuration->logging, "virtual_bench"); !logging)
    return complain(logging.error(), kBadUsage);
  auto bus = make_bus(*configuration);
  if (!bus) return complain(bus.error(), kInternalFailure);
  prepare_process_end();
  for (const int signal : {SIGTERM, SIGINT})
    std::signal(signal, [](int) {
      stop = 1;
      end_process_in(kServiceStops, kOk);
    });
  arguments.actuator.installed = *start;
  const AcceleratedClock clock(real, *start, arguments.acceleration);
  const Status served = serve(**bus, clock, *configuration, arguments.actuator);
  return served ? kOk : complain(served.error(), kInternalFailure);
}

}  // namespace

int run_bench(int argc, const char* const* argv, const BusMaker& make_bus) {
  int status = kInternalFailure;
  try {
    auto arguments = parse(argc, argv);
    status = arguments ? run(*arguments, make_bus) : arguments.error();
  } catch (const std::exception& exception) {
    complain(Error{{}, {}, {}, exception.what(), "this is a fault of the program: report it"}, kInternalFailure);
  }
  stop_logging();
  keep_process();
  return status;
}

}  // namespace sealwatch::bench

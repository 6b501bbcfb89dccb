// Arguments of the commands that run services and look at what they say.
#include <memory>

#include "services/cli/arguments.hpp"
#include "services/cli/command_line.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/publish.hpp"

namespace sealwatch::cli {
namespace {

void add_replay(CommandLine& line) {
  const auto options = std::make_shared<ReplayOptions>();
  CLI::App* replay =
      line.command("replay", "play recorded tests through the services, or --offline in process",
                   "sealwatch replay --with-services recordings/*.csv", [options] { return run_replay(*options); });
  CommandLine::add_config(replay, options->config);
  replay
      ->add_option("recordings", options->recordings,
                   "recordings (CSV or MAT), played in the order of their start times")
      ->required();
  replay
      ->add_option("--speed", options->speed,
                   "1 (as recorded) to 1000, or max; the time between tests is always skipped")
      ->capture_default_str();
  replay
      ->add_option("--asset", options->asset_file,
                   "asset file: all recordings are of this asset; offline it also replaces the configured one")
      ->check(an_asset_file, "FILE");
  CommandLine::add_map(replay, options->map_file);
  replay->add_option("--results", options->results_directory,
                     "directory for all messages: one file per topic, one JSON line per message");
  replay->add_option("--page", options->page,
                     "HTML file to write at the end: forecast of each asset, history, decision, reasons");
  replay->add_flag("--offline", options->offline, "run the same layers in this process, without DDS and services");
  CLI::Option* with_services =
      replay->add_flag("--with-services", options->with_services, "run the six services for the duration of the replay")
          ->excludes("--offline");
  replay
      ->add_option("--state", options->state_directory,
                   "state directory of those services instead of the configuration's")
      ->needs(with_services);
  replay->add_flag("--json", options->json, "advisories and the last forecasts as JSON lines on standard output");
  replay->add_flag("--quiet", options->quiet, "only the final screen");
}

void add_watch(CommandLine& line) {
  const auto options = std::make_shared<WatchOptions>();
  CLI::App* watch = line.command("watch", "show topics live", "sealwatch watch advisory remaining_life",
                                 [options] { return run_watch(*options); });
  CommandLine::add_config(watch, options->config);
  watch->add_option("topics", options->topics, "topics by name, including service_status (default: all but samples)");
  watch->add_option("--asset", options->asset_id, "only this asset");
  watch->add_option("--seconds", options->seconds, "stop after this time (default: until interrupted)")
      ->check(not_negative);
  watch->add_flag("--json", options->json, "one JSON object a line");
}

void add_publish(CommandLine& line) {
  const auto options = std::make_shared<PublishOptions>();
  CLI::App* publish = line.command("publish", "publish sample blocks given as JSON lines on standard input",
                                   "sealwatch publish < blocks.jsonl", [options] { return run_publish(*options); });
  CommandLine::add_config(publish, options->config);
}

void add_up(CommandLine& line) {
  const auto options = std::make_shared<UpOptions>();
  CLI::App* up = line.command("up", "start the six services here and keep them running", "sealwatch up --config config",
                              [options] { return run_up(*options); });
  CommandLine::add_config(up, options->config);
  up->add_option("--state", options->state_directory, "state directory instead of the configuration's");
  up->add_option("--security", options->security,
                 "each service under its own identity in this directory (docs/security.md)")
      ->type_name("DIR");
}

void add_status(CommandLine& line) {
  const auto options = std::make_shared<StatusOptions>();
  CLI::App* status = line.command("status", "show the services' state and the latest advice", "sealwatch status",
                                  [options] { return run_status(*options); });
  CommandLine::one_means(status,
                         "a service is in trouble, or an active alarm says that something is not seen (not those that "
                         "ask for maintenance)");
  CommandLine::add_config(status, options->config);
  status->add_option("--seconds", options->seconds, "how long to listen")
      ->check(CLI::Range(0.5, 60.0))
      ->check(a_number)
      ->capture_default_str();
  status->add_flag("--json", options->json, "machine-readable result (schema sealwatch.status/1)");
}

void add_show(CommandLine& line) {
  const auto options = std::make_shared<ShowOptions>();
  CLI::App* show = line.command("show", "open a message and trace it back to the waveform",
                                "sealwatch show XT03-MV2 --state demo/state", [options] { return run_show(*options); });
  CommandLine::add_config(show, options->config);
  show->add_option("id", options->id,
                   "message id, PST id of a test or its beginning, or asset id for its newest advisory")
      ->required();
  show->add_option("--state", options->state_directory,
                   "state directory of the services (running or not), instead of the configuration's");
  show->add_option("--csv", options->csv, "file to write the waveform of the test to, as a recording");
  show->add_flag("--json", options->json, "machine-readable result (schema sealwatch.message/1): the message in full");
}

}  // namespace

void add_services(CommandLine& line) {
  line.begin_group("Run");
  for (const auto add : {&add_replay, &add_watch, &add_publish, &add_up, &add_status, &add_show}) add(line);
}

}  // namespace sealwatch::cli

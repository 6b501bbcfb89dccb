// `sealwatch`: one program with subcommands for engineers and operators. Arguments only; each command is in its own
// file.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <exception>
#include <functional>
#include <iostream>
#include <map>

#include "sealwatch/core/text.hpp"
#include "services/cli/arguments.hpp"
#include "services/cli/build_version.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/completion.hpp"
#include "services/cli/manual.hpp"
#include "services/cli/publish.hpp"
#include "services/cli/session.hpp"
#include "services/cli/supervisor.hpp"
#include "services/verification/command/arguments.hpp"

namespace sealwatch::cli {
namespace {

/// The command line: its options, and what to run when it has been parsed.
class CommandLine {
 public:
  CommandLine() : app_("sealwatch: condition monitoring of electro-hydrostatic subsea valve actuators", "sealwatch") {
    app_.set_version_flag("--version",
                          std::string("sealwatch " SEALWATCH_VERSION " (").append(build_version()).append(")"));
    app_.require_subcommand(1);
    app_.footer(std::string("First steps: sealwatch replay --with-services RECORDING.csv...\n") + kExitStatus);
    add_recordings();
    add_estimation();
    add_verification();
    add_live();
    add_show();
    add_operator();
    add_alarms();
    add_retract();
    add_confirm();
    add_quarantine();
    add_audit();
    add_backup();
    add_accept();
    add_plant();
    add_laws();
    add_fleet();
    add_asset();
    add_configuration();
    group_commands();
  }

  int run(int argc, char** argv) {
    if (argc > 1 && argv[1][0] != '-' && !is_command(argv[1])) return unknown(argv[1]);
    arguments_.assign(argv + 1, argv + argc + 1);  // of the laboratory's program: its name in the place of "verify"
    try {
      app_.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
      return app_.exit(error) == 0 ? kOk : kBadInput;
    }
    return chosen_();
  }

 private:
  std::vector<std::string> commands() const {
    std::vector<std::string> names;
    for (const CLI::App* subcommand : app_.get_subcommands(nullptr)) names.push_back(subcommand->get_name());
    return names;
  }
  bool is_command(const std::string& name) const {
    const std::vector<std::string> names = commands();
    return std::find(names.begin(), names.end(), name) != names.end();
  }
  int unknown(const std::string& name) const {
    complain(
        Error{.file = {}, .place = {}, .value = name, .rule = "is not a command", .advice = suggest(name, commands())});
    return kBadInput;
  }

  CLI::App* command(const std::string& name, const std::string& meaning, const std::string& example,
                    std::function<int()> run) {
    CLI::App* subcommand = app_.add_subcommand(name, meaning);
    subcommand->footer("Example:\n  " + example + "\n" + kExitStatus);
    subcommand->callback([this, run = std::move(run)] { chosen_ = run; });
    return subcommand;
  }

  /// A command that only holds others.
  CLI::App* holder(const std::string& name, const std::string& meaning, const std::string& example) {
    CLI::App* subcommand = app_.add_subcommand(name, meaning);
    subcommand->require_subcommand(1);
    subcommand->footer("Example:\n  " + example + "\n" + kExitStatus);
    return subcommand;
  }

  /// In `--help`; a command that is in no group would stand under "Subcommands".
  void group_commands() {
    for (const auto& [group, names] : std::initializer_list<std::pair<const char*, std::vector<const char*>>>{
             {"Analyse",
              {"simulate", "fit", "validate", "explain", "forecast", "verify", "plant", "laws", "fleet", "asset"}},
             {"Run", {"up", "replay", "watch", "publish", "status", "show"}},
             {"Operate",
              {"acknowledge", "shelve", "unshelve", "out-of-service", "in-service", "replaced", "retract", "confirm",
               "accept"}},
             {"Maintain", {"config", "quarantine", "audit", "backup", "restore", "completion", "manual"}}})
      for (const char* name : names) app_.get_subcommand(name)->group(group);
  }

  static void add_config(CLI::App* subcommand, std::string& config) {
    config = default_config();
    subcommand->add_option("--config", config, "configuration file or directory ($SEALWATCH_CONFIG)")
        ->capture_default_str();
  }

  /// What every command that reads recordings takes.
  static void add_map(CLI::App* subcommand, std::string& map_file) {
    subcommand
        ->add_option(
            "--map", map_file,
            "YAML file with channels: (columns and units of your own log, docs/logs.md); replaces the asset file's")
        ->check(CLI::ExistingFile);
  }

  void add_recordings() {
    CLI::App* simulate =
        command("simulate", "simulate tests on the virtual bench, or any plant's outputs",
                "sealwatch simulate --asset config/assets/xt03-mv2.yaml --ageing --months 108 --out recordings\n"
                "  sealwatch simulate --asset valve-7.yaml --input inputs.csv --out simulated",
                [this] { return run_simulate(simulate_); });
    simulate->add_option("--asset", simulate_.asset_file, "asset file")->required()->check(an_asset_file, "FILE");
    simulate->add_option("--out", simulate_.directory, "directory for the recordings (created if absent)")->required();
    simulate->add_option("--months", simulate_.months, "number of monthly tests")
        ->check(CLI::Range(1, 600))
        ->capture_default_str();
    simulate->add_option("--start", simulate_.start, "UTC time of installation; the first test is a month later")
        ->capture_default_str();
    simulate->add_option("--seed", simulate_.seed, "same seed, same recordings")
        ->check(not_negative)
        ->capture_default_str();
    simulate->add_option("--rate", simulate_.sample_rate_Hz, "samples a second")
        ->check(CLI::Range(10.0, 5000.0))
        ->check(a_number)
        ->capture_default_str();
    simulate->add_option("--condition", simulate_.condition, "seal condition theta at the first test")
        ->check(CLI::Range(0.05, 1.2))
        ->check(a_number)
        ->capture_default_str();
    simulate->add_flag("--ageing", simulate_.ageing,
                       "let the seal age month by month until it fails or the months are over");
    simulate->add_option("--missing", simulate_.missing_share, "share of months without a test")
        ->check(CLI::Range(0.0, 0.9))
        ->check(a_number)
        ->capture_default_str();
    simulate->add_option("--cut", simulate_.cut_share, "share of tests cut short")
        ->check(CLI::Range(0.0, 1.0))
        ->check(a_number)
        ->capture_default_str();
    CLI::Option* input = simulate->add_option(
        "--input", simulate_.inputs,
        "files with the inputs of the asset's plant (text, FMU or built in): writes what it gives at their samples, "
        "in place of the bench's tests; outputs that they have tell where states start");
    simulate->add_flag("--noise", simulate_.noise, "with --input: add the sensors' noise")->needs(input);
    add_map(simulate, simulate_.map_file);
  }

  void add_estimation() {
    CLI::App* fit = command("fit", "estimate parameters from recorded tests (gray-box PEM)",
                            "sealwatch fit --asset config/assets/xt03-mv2.yaml 2016-03.csv --json",
                            [this] { return run_fit(fit_); });
    fit->add_option("--asset", fit_.asset_file, "asset file")->required()->check(an_asset_file, "FILE");
    fit->add_option("recordings", fit_.recordings, "recordings, fitted jointly (CSV or MAT)")->required();
    add_map(fit, fit_.map_file);
    fit->add_option("--model", fit_.model,
                    "cylinder_circuit, or the asset's whole model (default: the best the channels allow)");
    fit->add_flag("--json", fit_.json, "machine-readable result (schema sealwatch.fit/1)");

    CLI::App* validate =
        command("validate", "compare simulation with recordings, channel by channel",
                "sealwatch validate --asset config/assets/bench_eha.yaml stroke1.csv stroke2.csv --out validation\n"
                "  sealwatch validate --simulated sim.csv recorded.csv --page trace.html",
                [this] { return run_validate(validate_); });
    validate->add_option("--asset", validate_.asset_file, "asset file")->check(an_asset_file, "FILE");
    validate->add_option("recordings", validate_.recordings, "recordings (CSV or MAT)")->required();
    validate->add_option("--out", validate_.directory, "directory for the report (made if absent)");
    CLI::Option* simulated = validate->add_option(
        "--simulated", validate_.simulated,
        "trace of your own simulation, compared with one recording without a model: whether they differ beyond noise, "
        "when, and whether a gain, offset, delay, clock rate or sign explains it (exit status 1: they differ)");
    validate->add_option("--page", validate_.page, "with --simulated: HTML file to write")->needs(simulated);
    validate
        ->add_option("--input", validate_.inputs,
                     "with --simulated: channels that drive the simulation (default: the asset's)")
        ->needs(simulated);
    add_map(validate, validate_.map_file);
    validate->add_flag("--fit", validate_.fit, "estimate the asset's free parameters from these recordings first");
    validate->add_flag("--json", validate_.json,
                       "machine-readable result (schema sealwatch.validation/1, of a trace sealwatch.trace/1)");

    add_explain();

    add_forecast();
  }

  void add_forecast() {
    CLI::App* forecast = command("forecast", "forecast the remaining useful life",
                                 "sealwatch forecast --asset XT03-MV2 --state demo/state --page forecast.html\n"
                                 "  sealwatch forecast --history history.csv --before 2019-06-01 --json",
                                 [this] { return run_forecast(forecast_); });
    CLI::Option* history = forecast->add_option(
        "--history", forecast_.history_file,
        "CSV: time[iso8601],theta[1],theta_std[1] (or R_CL[Pa s/m3] with --asset); default: the services' journals");
    forecast
        ->add_option("--state", forecast_.state_directory,
                     "state directory of the services (running or not), instead of the configuration's")
        ->excludes(history);
    forecast->add_option("--asset", forecast_.asset,
                         "asset file: seal resistances and threshold; without --history also an asset's id");
    forecast->add_option("--before", forecast_.before, "dates for which to give the probability of failure");
    forecast->add_option("--config", forecast_.config,
                         "configuration file or directory: campaigns, costs and forecasters of the asset's site; "
                         "without --history as for other commands");
    forecast
        ->add_option("--costs", forecast_.costs,
                     "what replacements cost: PLANNED,AFTER_FAILURE,FAILED_MONTH,UNUSED_MONTH")
        ->delimiter(',');
    forecast->add_option("--page", forecast_.page, "HTML file to write: advice, history, forecast, decision, reasons");
    forecast->add_option("--threshold", forecast_.threshold, "seal condition below which it has failed")
        ->check(CLI::Range(0.0, 1.0))
        ->check(a_number)
        ->capture_default_str()
        ->each([this](const std::string&) { forecast_.threshold_given = true; });
    forecast->add_flag("--json", forecast_.json, "machine-readable result (schema sealwatch.forecast/1)");
  }

  // Its work is done by a program of its own: whoever monitors actuators does not load the laboratory.
  void add_verification() {
    CLI::App* verify =
        app_.add_subcommand("verify", "verify estimates, forecasts and explanations against known truths");
    verify->footer(std::string("Example:\n  sealwatch verify mismatch --help\n") + kExitStatus);
    add_verify_arguments(*verify, verify_, [this](VerifyPart) { chosen_ = [this] { return run_laboratory(); }; });
  }

  int run_laboratory() {
    const std::string program = program_path("sealwatch-verify");
    arguments_.front() = const_cast<char*>(program.c_str());
    ::execvp(program.c_str(), arguments_.data());
    complain(Error{.file = program,
                   .place = {},
                   .value = std::strerror(errno),
                   .rule = "cannot be run",
                   .advice = "it belongs beside sealwatch; `deploy/build.sh release` builds it"});
    return kInternalFailure;
  }

  void add_explain() {
    CLI::App* explain =
        command("explain", "find, name and prove physics that the simulation lacks",
                "sealwatch explain --asset asset.yaml --fit fit_*.csv --holdout holdout_*.csv --out found",
                [this] { return run_explain(explain_); });
    explain->add_option("--asset", explain_.asset_file, "asset file")->required()->check(an_asset_file, "FILE");
    explain->add_option("--fit", explain_.fit, "recordings to fit: tests that differ in load, speed or profile")
        ->required();
    explain->add_option("--holdout", explain_.holdout,
                        "held-out recordings for the proof (default: each fitted one is left out in turn)");
    explain
        ->add_option("--out", explain_.directory,
                     "directory for report.json, report.html and asset.explained.yaml (made if absent)")
        ->required();
    add_map(explain, explain_.map_file);
    explain->add_option("--seed", explain_.seed, "same seed, same report")->check(not_negative)->capture_default_str();
    explain
        ->add_option("--time-limit", explain_.time_limit_s,
                     "seconds after which the best answer so far is given, with a list of what was not tried")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    explain->add_option("--threads", explain_.threads, "threads to compute with")
        ->check(CLI::Range(1, 256))
        ->capture_default_str();
    explain->add_flag("--json", explain_.json, "the report (schema sealwatch.mismatch/1) on standard output");
  }

  void add_live() {
    CLI::App* replay =
        command("replay", "play recorded tests through the services, or --offline in process",
                "sealwatch replay --with-services recordings/*.csv", [this] { return run_replay(replay_); });
    add_config(replay, replay_.config);
    replay->add_option("recordings", replay_.recordings, "recordings in the order of the tests (CSV or MAT)")
        ->required();
    replay
        ->add_option("--speed", replay_.speed,
                     "1 (as recorded) to 1000, or max; the time between tests is always skipped")
        ->capture_default_str();
    replay
        ->add_option("--asset", replay_.asset_file,
                     "asset file: all recordings are of this asset; offline it also replaces the configured one")
        ->check(an_asset_file, "FILE");
    add_map(replay, replay_.map_file);
    replay->add_option("--results", replay_.results_directory,
                       "directory for all messages: one file per topic, one JSON line per message");
    replay->add_option("--page", replay_.page,
                       "HTML file to write at the end: forecast of each asset, history, decision, reasons");
    replay->add_flag("--offline", replay_.offline, "run the same layers in this process, without DDS and services");
    replay->add_flag("--with-services", replay_.with_services, "run the six services for the duration of the replay")
        ->excludes("--offline");
    replay->add_option("--state", replay_.state_directory,
                       "state directory of those services instead of the configuration's");
    replay->add_flag("--json", replay_.json, "advisories and the last forecasts as JSON lines on standard output");
    replay->add_flag("--quiet", replay_.quiet, "only the final screen");

    CLI::App* watch = command("watch", "show topics live", "sealwatch watch advisory remaining_life",
                              [this] { return run_watch(watch_); });
    add_config(watch, watch_.config);
    watch->add_option("topics", watch_.topics, "topics by name, including service_status (default: all but samples)");
    watch->add_option("--asset", watch_.asset_id, "only this asset");
    watch->add_option("--seconds", watch_.seconds, "stop after this time (default: until interrupted)")
        ->check(not_negative);
    watch->add_flag("--json", watch_.json, "one JSON object a line");

    CLI::App* publish = command("publish", "publish sample blocks given as JSON lines on standard input",
                                "sealwatch publish < blocks.jsonl", [this] { return run_publish(publish_); });
    add_config(publish, publish_.config);

    CLI::App* up = command("up", "start the six services here and keep them running", "sealwatch up --config config",
                           [this] { return run_up(up_); });
    add_config(up, up_.config);
    up->add_option("--state", up_.state_directory, "state directory instead of the configuration's");
    up->add_option("--security", up_.security,
                   "each service under its own identity in this directory (docs/security.md)")
        ->type_name("DIR");

    CLI::App* status = command("status", "show the services' state and the latest advice", "sealwatch status",
                               [this] { return run_status(status_); });
    add_config(status, status_.config);
    status->add_option("--seconds", status_.seconds, "how long to listen")
        ->check(CLI::Range(0.5, 60.0))
        ->check(a_number)
        ->capture_default_str();
    status->add_flag("--json", status_.json, "machine-readable result (schema sealwatch.status/1)");
  }

  void add_show() {
    CLI::App* show = command("show", "open a message and trace it back to the waveform",
                             "sealwatch show XT03-MV2 --state demo/state", [this] { return run_show(show_); });
    add_config(show, show_.config);
    show->add_option("id", show_.id, "message id, or a test's PST id, or an asset id for its newest advisory")
        ->required();
    show->add_option("--state", show_.state_directory,
                     "state directory of the services (running or not), instead of the configuration's");
    show->add_option("--csv", show_.csv, "file to write the waveform of the test to, as a recording");
    show->add_flag("--json", show_.json, "machine-readable result (schema sealwatch.message/1): the message in full");
  }

  void add_operator() {
    CLI::App* acknowledge = command("acknowledge", "acknowledge an advisory or an alarm",
                                    "sealwatch acknowledge XT03-MV2 ADVISORY_ID --by 'J. Silva'",
                                    [this] { return run_acknowledge(acknowledge_); });
    add_config(acknowledge, acknowledge_.config);
    acknowledge->add_option("asset", acknowledge_.asset_id, "asset id; - for an alarm about no asset")->required();
    acknowledge
        ->add_option("advisory", acknowledge_.advisory_id, "advisory id, or an alarm's id as `status --json` shows it")
        ->required();
    acknowledge->add_option("--by", acknowledge_.by, "who")->required();
    acknowledge->add_option("--remark", acknowledge_.remark, "free text");

    CLI::App* replaced = command("replaced", "report a replaced actuator or seal: its histories restart",
                                 "sealwatch replaced XT03-MV2 --at 2018-05-02 --by 'J. Silva'",
                                 [this] { return run_replaced(replaced_); });
    add_config(replaced, replaced_.config);
    replaced->add_option("asset", replaced_.asset_id, "asset id")->required();
    replaced->add_option("--at", replaced_.at, "UTC time of the replacement")->required();
    replaced->add_option("--what", replaced_.what, "actuator or seal")
        ->check(CLI::IsMember({"actuator", "seal"}))
        ->capture_default_str();
    replaced->add_option("--by", replaced_.by, "who")->required();
    replaced->add_option("--remark", replaced_.remark, "free text");
  }

  void add_alarms() {
    CLI::App* shelve = command("shelve", "hide an alarm or advisory until a date",
                               "sealwatch shelve XT03-MV2 sensor_lost/pressure_a --until 2031-06-01 --by 'J. Silva' "
                               "--reason 'sensor ordered'",
                               [this] { return run_shelve(shelve_); });
    shelve->add_option("--until", shelve_.until, "UTC time, at most a year ahead")->required();
    CLI::App* unshelve = command("unshelve", "show a shelved alarm again",
                                 "sealwatch unshelve XT03-MV2 sensor_lost/pressure_a --by 'J. Silva'",
                                 [this] { return run_shelve(shelve_); });
    for (CLI::App* one : {shelve, unshelve}) {
      add_config(one, shelve_.config);
      one->add_option("asset", shelve_.asset_id, "asset id; - for an alarm about no asset")->required();
      one->add_option("alarm", shelve_.alarm_id, "the alarm's id as `status --json` shows it")->required();
      one->add_option("--by", shelve_.by, "who")->required();
    }
    shelve->add_option("--reason", shelve_.reason, "why")->required();
    unshelve->add_option("--reason", shelve_.reason, "why");
    CLI::App* out = command("out-of-service", "hide an asset's alarms during work on it",
                            "sealwatch out-of-service XT03-MV2 --by 'J. Silva' --reason 'valve is being replaced'",
                            [this] { return run_out_of_service(out_of_service_); });
    out->add_option("--reason", out_of_service_.reason, "why")->required();
    CLI::App* in =
        command("in-service", "show an asset's alarms again", "sealwatch in-service XT03-MV2 --by 'J. Silva'", [this] {
          out_of_service_.back = true;
          return run_out_of_service(out_of_service_);
        });
    in->add_option("--reason", out_of_service_.reason, "free text");
    for (CLI::App* one : {out, in}) {
      add_config(one, out_of_service_.config);
      one->add_option("asset", out_of_service_.asset_id, "asset id")->required();
      one->add_option("--by", out_of_service_.by, "who")->required();
    }
  }

  void add_retract() {
    CLI::App* retract = command("retract", "exclude a test, or all since a date (reversible)",
                                "sealwatch retract XT03-MV2 --test PST_ID --by 'J. Silva' --reason 'wrong valve'",
                                [this] { return run_retract(retract_); });
    add_config(retract, retract_.config);
    retract->add_option("asset", retract_.asset_id, "asset id")->required();
    CLI::Option_group* what = retract->add_option_group("what");
    what->add_option("--test", retract_.pst_id, "the test's PST id, as shown by `show` and `status`");
    what->add_option("--since", retract_.since, "UTC time: all tests known now that were made at or after it");
    what->add_option("--withdraw", retract_.withdraw, "id of a retraction: its tests count again");
    what->require_option(1);
    retract->add_option("--by", retract_.by, "who")->required();
    retract->add_option("--reason", retract_.reason, "why")->required();
  }

  void add_confirm() {
    CLI::App* confirm =
        command("confirm", "confirm another person's act where two people are required",
                "sealwatch confirm XT03-MV2 ACT_ID --by 'M. Okoye'", [this] { return run_confirm(confirm_); });
    add_config(confirm, confirm_.config);
    confirm->add_option("asset", confirm_.asset_id, "asset id")->required();
    confirm
        ->add_option("act", confirm_.act_id,
                     "id of the waiting replacement, retraction or accepted model, as `status` shows it")
        ->required();
    confirm->add_flag("--reject", confirm_.reject, "reject it instead; the person who reported it may do so, too");
    confirm->add_option("--by", confirm_.by, "who: not the person who reported it")->required();
    confirm->add_option("--remark", confirm_.remark, "free text");
  }

  void add_quarantine() {
    CLI::App* quarantine = app_.add_subcommand("quarantine", "list or retry tests on which a service failed twice");
    quarantine->require_subcommand(1);
    quarantine->footer(std::string("Examples:\n  sealwatch quarantine list --state STATE\n"
                                   "  sealwatch quarantine retry test_window/XT03-MV2-20180324T033939Z-ca97c069 --by "
                                   "'J. Silva'\n") +
                       kExitStatus);
    CLI::App* list = quarantine->add_subcommand("list", "list what is in quarantine, since when and why");
    list->footer(std::string("Example:\n  sealwatch quarantine list --state /var/lib/sealwatch\n") + kExitStatus +
                 " Here 1 means that something is in quarantine.");
    list->add_flag("--all", quarantine_.all, "also show past retries and who requested them");
    list->add_flag("--json", quarantine_.json, "machine-readable result (schema sealwatch.quarantine/1)");
    list->callback([this] { chosen_ = [this] { return run_quarantine_list(quarantine_); }; });
    CLI::App* retry = quarantine->add_subcommand("retry", "process a message and its test again");
    retry->footer(
        std::string("Example:\n  sealwatch quarantine retry sample_block/XT03-MV2-20180324T033939Z-ca97c069/30 "
                    "--by 'J. Silva'\nA running service retries it within seconds, a stopped one when it starts. "
                    "If it fails twice again, it returns to quarantine.\n") +
        kExitStatus);
    retry->add_option("id", quarantine_.message_id, "message id, or PST id, as `quarantine list` shows it")->required();
    retry->add_option("--by", quarantine_.by, "who")->required();
    retry->callback([this] { chosen_ = [this] { return run_quarantine_retry(quarantine_); }; });
    for (CLI::App* one : {list, retry}) {
      add_config(one, quarantine_.config);
      one->add_option("--state", quarantine_.state_directory,
                      "state directory of the services (running or not), instead of the configuration's");
    }
  }

  void add_audit() {
    CLI::App* audit = command("audit", "audit trail of operator actions, with an integrity check",
                              "sealwatch audit --state STATE\n  sealwatch audit --asset XT03-MV2 --json\n  sealwatch "
                              "audit --contains HASH",
                              [this] { return run_audit(audit_); });
    add_config(audit, audit_.config);
    audit->add_option("--state", audit_.state_directory,
                      "state directory of the services (running or not), instead of the configuration's");
    audit->add_option("--asset", audit_.asset_id,
                      "show the actions on one asset; the whole trail is checked all the same");
    audit->add_option("--contains", audit_.contains,
                      "check that a hash noted earlier is still in the trail (if not, the trail was truncated)");
    audit->add_flag("--json", audit_.json, "machine-readable result (schema sealwatch.audit/1)");
  }

  void add_backup() {
    CLI::App* backup =
        command("backup", "copy the services' journals while they run (without configuration)",
                "sealwatch backup --state STATE --to /backup/2031-04-12", [this] { return run_backup(backup_); });
    backup->add_option("--to", backup_.directory, "directory for the copies: SERVICE.db")->required();
    CLI::App* restore =
        command("restore", "replace the journals of stopped services by a backup",
                "sealwatch restore --state STATE --from /backup/2031-04-12", [this] { return run_restore(backup_); });
    restore
        ->add_option(
            "--from", backup_.directory,
            "directory with the copies: SERVICE.db of each to restore; the present journals are kept beside them")
        ->required();
    for (CLI::App* one : {backup, restore}) {
      add_config(one, backup_.config);
      one->add_option("--state", backup_.state_directory, "state directory of the services");
    }
  }

  void add_accept() {
    CLI::App* accept = command("accept", "let the services use an explained model, or --revoke it",
                               "sealwatch accept --asset-id XT03-MV2 --discrepancy ID --by 'J. Silva'",
                               [this] { return run_accept(accept_); });
    add_config(accept, accept_.config);
    accept->add_option("--asset-id", accept_.asset_id, "asset id")->required();
    accept->add_option("--discrepancy", accept_.discrepancy_id, "id of the model_discrepancy, as `status` shows it")
        ->required();
    accept->add_flag("--revoke", accept_.revoke, "return to the model of the asset file");
    accept->add_option("--by", accept_.by, "who")->required();
    accept->add_option("--remark", accept_.remark, "free text");
  }

  void add_plant() {
    CLI::App* plant = holder("plant", "check, import and export plants: text files and FMUs",
                             "sealwatch plant check config/plants/spring_return.yaml");
    CLI::App* unit = plant->add_subcommand("import", "write a draft plant file for an FMU");
    unit->footer(std::string("Example:\n  sealwatch plant import model.fmu --out model.yaml\n") + kExitStatus);
    unit->callback([this] { chosen_ = [this] { return run_plant_import(plant_import_); }; });
    unit->add_option("fmu", plant_import_.fmu, "FMU of FMI 2.0 or 3.0, for Linux on x86-64")->required();
    unit->add_option("--out", plant_import_.file, "plant file to write (YAML)")->required();
    unit->add_option("--interface", plant_import_.interface, "me or cs, of a unit that has both; without it me")
        ->check(CLI::IsMember({"me", "cs"}));
    unit->add_option("--set", plant_import_.settings, "NAME=VALUE: a parameter that is set once, as a size or a text")
        ->allow_extra_args(false);
    CLI::App* back = plant->add_subcommand("export", "write an asset's plant with its laws as an FMU");
    back->footer(
        std::string("Example:\n  sealwatch plant export --asset report/asset.explained.yaml --fmu explained.fmu\n") +
        kExitStatus);
    back->callback([this] { chosen_ = [this] { return run_plant_export(plant_export_); }; });
    back->add_option("--asset", plant_export_.asset_file, "asset file")->required()->check(an_asset_file, "FILE");
    back->add_option("--fmu", plant_export_.fmu, "FMU to write (FMI 2.0, Model Exchange)")->required();
    CLI::App* check = plant->add_subcommand("check", "show how a plant file is read, or every fault in it");
    check->footer(std::string("Example:\n  sealwatch plant check config/plants/spring_return.yaml\n") + kExitStatus);
    check->callback([this] { chosen_ = [this] { return run_plant_check(plant_check_); }; });
    check->add_option("file", plant_check_.file, "the plant's YAML file")->required();
    check->add_flag("--json", plant_check_.json, "machine-readable result");
    CLI::App* show = plant->add_subcommand("show", "states, channels, parameters and elements of a plant");
    show->footer(std::string("Example:\n  sealwatch plant show eha\n"
                             "  sealwatch plant show config/plants/spring_return.yaml --json\n") +
                 kExitStatus);
    show->callback([this] { chosen_ = [this] { return run_plant_show(plant_show_); }; });
    show->add_option("plant", plant_show_.name, "eha, eha_switched, emps, cascaded_tanks, or a plant's YAML file")
        ->required();
    show->add_flag("--json", plant_show_.json, "machine-readable (schema sealwatch.plant/1)");
  }

  void add_laws() {
    CLI::App* laws = command("laws", "list the catalogue of physics that explain searches",
                             "sealwatch laws\n  sealwatch laws piston\n  sealwatch laws coulomb_friction --json",
                             [this] { return run_laws(laws_); });
    laws->add_option("asked", laws_.asked, "a law's id, an element of a plant, or a kind of site (default: all)");
    laws->add_flag("--json", laws_.json, "machine-readable (schema sealwatch.laws/1)");
  }

  void add_fleet() {
    CLI::App* fleet = holder("fleet", "estimate a fleet's ageing constants from its histories",
                             "sealwatch fleet fit life1.csv life2.csv life3.csv");
    CLI::App* fit =
        fleet->add_subcommand("fit", "estimate ageing constants with uncertainty, for the forecasts' configuration");
    fit->footer(std::string("Example:\n  sealwatch fleet fit life1.csv life2.csv life3.csv\n") + kExitStatus);
    fit->callback([this] { chosen_ = [this] { return run_fleet_fit(fleet_fit_); }; });
    fit->add_option("histories", fleet_fit_.histories,
                    "one per life: CSV time[iso8601],theta[1],theta_std[1] (or R_CL[Pa s/m3] with --asset)")
        ->required();
    fit->add_option("--installed", fleet_fit_.installed,
                    "date of each seal's installation (default: a month before its first test)")
        ->delimiter(',');
    fit->add_option("--asset", fleet_fit_.asset_file, "asset file: seal resistances")->check(an_asset_file, "FILE");
    fit->add_flag("--json", fleet_fit_.json, "machine-readable result (schema sealwatch.fleet/1)");
  }

  void add_asset() {
    CLI::App* asset =
        holder("asset", "write an asset file from your own log", "sealwatch asset new --from log.csv --out asset.yaml");
    CLI::App* fresh =
        asset->add_subcommand("new", "write an asset file with a channel map: guesses, asks, shows the result");
    fresh->footer(std::string("Example:\n  sealwatch asset new --from log.csv --out asset.yaml\n") + kExitStatus);
    fresh->callback([this] { chosen_ = [this] { return run_asset_new(asset_new_); }; });
    fresh->add_option("--from", asset_new_.log, "your log: text in columns, MATLAB or HDF5")->required();
    fresh->add_option("--out", asset_new_.file, "asset file to write, with a picture beside it (.html)")->required();
    fresh->add_option("--model", asset_new_.model,
                      "built-in plant (default: best match to the columns), or a plant file");
    fresh->add_option("--id", asset_new_.asset_id, "asset id (default: the log's name)");
    fresh->add_flag("--yes", asset_new_.yes, "accept the guess without asking");
  }

  void add_configuration() {
    CLI::App* config = holder("config", "check the configuration", "sealwatch config check --config /etc/sealwatch");
    CLI::App* check = config->add_subcommand("check", "list every fault in the configuration, with file and line");
    check->footer(std::string("Example:\n  sealwatch config check --config /etc/sealwatch\n") + kExitStatus);
    check->callback([this] { chosen_ = [this] { return run_config_check(config_check_); }; });
    add_config(check, config_check_.config);
    check->add_flag("--json", config_check_.json, "machine-readable result");

    CLI::App* completion = command("completion", "print a completion script for bash or zsh",
                                   "source <(sealwatch completion bash)", [this] {
                                     std::cout << completion_script(app_, completion_.shell);
                                     return kOk;
                                   });
    completion->add_option("shell", completion_.shell, "bash or zsh")
        ->check(CLI::IsMember({"bash", "zsh"}))
        ->capture_default_str();

    command("manual", "print this program's manual page", "sealwatch manual | man -l -", [this] {
      std::cout << manual_page(app_, SEALWATCH_VERSION);
      return kOk;
    });
  }

  CLI::App app_;
  std::vector<char*> arguments_;  ///< without the program's name, ends with nullptr
  std::function<int()> chosen_ = [] { return kBadInput; };
  SimulateOptions simulate_;
  FitOptions fit_;
  ExplainOptions explain_;
  ForecastOptions forecast_;
  ValidateOptions validate_;
  AssetNewOptions asset_new_;
  FleetFitOptions fleet_fit_;
  PlantImportOptions plant_import_;
  PlantExportOptions plant_export_;
  VerifyOptions verify_;
  ReplayOptions replay_;
  WatchOptions watch_;
  PublishOptions publish_;
  ShowOptions show_;
  UpOptions up_;
  StatusOptions status_;
  AcknowledgeOptions acknowledge_;
  QuarantineOptions quarantine_;
  BackupOptions backup_;
  ConfirmOptions confirm_;
  AuditOptions audit_;
  ReplacedOptions replaced_;
  ShelveOptions shelve_;
  OutOfServiceOptions out_of_service_;
  RetractOptions retract_;
  AcceptOptions accept_;
  ConfigCheckOptions config_check_;
  PlantCheckOptions plant_check_;
  PlantShowOptions plant_show_;
  LawsOptions laws_;
  CompletionOptions completion_;
};

}  // namespace
}  // namespace sealwatch::cli

int main(int argc, char** argv) {
  try {
    return sealwatch::cli::CommandLine().run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "sealwatch: internal failure: " << error.what() << "\n";
    return sealwatch::cli::kInternalFailure;
  }
}

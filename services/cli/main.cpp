// `sealwatch`: one program with subcommands for engineers and operators. Arguments only; each command is in its own
// file.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <functional>
#include <iostream>
#include <map>

#include "sealwatch/core/text.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/completion.hpp"
#include "services/cli/manual.hpp"
#include "services/cli/session.hpp"
#include "services/cli/verify.hpp"
#include "services/cli/verify_mismatch.hpp"

namespace sealwatch::cli {
namespace {

constexpr const char* kExitStatus =
    "Exit status: 0 ok; 1 it ran and the answer is \"no\"; 2 bad usage or input; 3 internal failure.";

std::string not_negative(const std::string& text) { return text.starts_with("-") ? "must not be negative" : ""; }

/// CLI::Range lets what is not a number pass.
std::string a_number(const std::string& text) {
  return std::isnan(std::strtod(text.c_str(), nullptr)) ? "must be a number" : "";
}

/// An asset is given by its file: whoever gives the id is told so.
std::string an_asset_file(const std::string& text) {
  if (std::filesystem::is_regular_file(text)) return {};
  return "wants an asset file, and '" + text + "' is none; for example --asset config/assets/xt03-mv2.yaml";
}

/// The command line: its options, and what to run when it has been parsed.
class CommandLine {
 public:
  CommandLine() : app_("sealwatch: condition monitoring of electro-hydrostatic subsea valve actuators", "sealwatch") {
    app_.set_version_flag("--version", std::string("sealwatch ") + SEALWATCH_VERSION);
    app_.require_subcommand(1);
    app_.footer(std::string("First steps: sealwatch replay --with-services RECORDING.csv...\n") + kExitStatus);
    add_recordings();
    add_estimation();
    add_verification();
    add_live();
    add_show();
    add_operator();
    add_accept();
    add_configuration();
  }

  int run(int argc, char** argv) {
    if (argc > 1 && argv[1][0] != '-' && !is_command(argv[1])) return unknown(argv[1]);
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

  static void add_config(CLI::App* subcommand, std::string& config) {
    config = default_config();
    subcommand->add_option("--config", config, "configuration file or directory ($SEALWATCH_CONFIG)")
        ->capture_default_str();
  }

  void add_recordings() {
    CLI::App* simulate =
        command("simulate", "record partial stroke tests of the virtual bench",
                "sealwatch simulate --asset config/assets/xt03-mv2.yaml --ageing --months 108 --out recordings",
                [this] { return run_simulate(simulate_); });
    simulate->add_option("--asset", simulate_.asset_file, "asset file")->required()->check(an_asset_file, "FILE");
    simulate->add_option("--out", simulate_.directory, "directory for the recordings (made if absent)")->required();
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
                       "let the seal age from month to month until it fails or the months are over");
    simulate->add_option("--missing", simulate_.missing_share, "share of the months that are never tested")
        ->check(CLI::Range(0.0, 0.9))
        ->check(a_number)
        ->capture_default_str();
    simulate->add_option("--cut", simulate_.cut_share, "share of the tests that are cut short")
        ->check(CLI::Range(0.0, 1.0))
        ->check(a_number)
        ->capture_default_str();
  }

  void add_estimation() {
    CLI::App* fit = command("fit", "estimate the actuator's parameters from recorded tests (gray-box PEM)",
                            "sealwatch fit --asset config/assets/xt03-mv2.yaml 2016-03.csv --json",
                            [this] { return run_fit(fit_); });
    fit->add_option("--asset", fit_.asset_file, "asset file")->required()->check(an_asset_file, "FILE");
    fit->add_option("recordings", fit_.recordings, "recordings, fitted jointly (CSV or MAT)")->required();
    fit->add_option("--model", fit_.model,
                    "cylinder_circuit, or the asset's whole model (default: the best the channels allow)");
    fit->add_flag("--json", fit_.json, "machine-readable result (schema sealwatch.fit/1)");

    CLI::App* validate =
        command("validate", "compare the model's simulation with recordings, channel by channel",
                "sealwatch validate --asset config/assets/bench_eha.yaml stroke1.csv stroke2.csv --out validation",
                [this] { return run_validate(validate_); });
    validate->add_option("--asset", validate_.asset_file, "asset file")->required()->check(an_asset_file, "FILE");
    validate->add_option("recordings", validate_.recordings, "recordings (CSV or MAT)")->required();
    validate->add_option("--out", validate_.directory, "directory for the report (made if absent)")->required();
    validate->add_flag("--fit", validate_.fit, "estimate the asset's free parameters from these recordings first");
    validate->add_flag("--json", validate_.json, "machine-readable result (schema sealwatch.validation/1)");

    add_explain();

    add_forecast();
  }

  void add_forecast() {
    CLI::App* forecast = command("forecast", "remaining useful life from what the services keep, or from a history",
                                 "sealwatch forecast --asset XT03-MV2 --state demo/state --page forecast.html\n"
                                 "  sealwatch forecast --history history.csv --before 2019-06-01 --json",
                                 [this] { return run_forecast(forecast_); });
    CLI::Option* history = forecast->add_option(
        "--history", forecast_.history_file,
        "CSV: time[iso8601],theta[1],theta_std[1] (or R_CL[Pa s/m3] with --asset); default: what the services keep");
    forecast
        ->add_option("--state", forecast_.state_directory,
                     "state directory of the services, which need not run, instead of the configuration's")
        ->excludes(history);
    forecast->add_option("--asset", forecast_.asset,
                         "asset file: seal resistances and threshold; without --history also an asset's id");
    forecast->add_option("--before", forecast_.before, "dates to give the probability of failure for");
    forecast->add_option("--config", forecast_.config,
                         "configuration file or directory: campaigns, costs and forecasters of the asset's site; "
                         "without --history as for the other commands");
    forecast
        ->add_option("--costs", forecast_.costs,
                     "what replacements cost: PLANNED,AFTER_FAILURE,FAILED_MONTH,UNUSED_MONTH")
        ->delimiter(',');
    forecast->add_option("--page", forecast_.page, "HTML file to write: history, forecast, decision, reasons");
    forecast->add_option("--threshold", forecast_.threshold, "seal condition at which it has failed")
        ->check(CLI::Range(0.0, 1.0))
        ->check(a_number)
        ->capture_default_str()
        ->each([this](const std::string&) { forecast_.threshold_given = true; });
    forecast->add_flag("--json", forecast_.json, "machine-readable result (schema sealwatch.forecast/1)");
  }

  void add_verification() {
    CLI::App* verify = app_.add_subcommand("verify", "verify estimates and forecasts on simulated lives");
    verify->require_subcommand(1);
    const auto part = [&](const char* name, const char* meaning, const char* example, std::function<int()> run) {
      CLI::App* subcommand = verify->add_subcommand(name, meaning);
      subcommand->footer(std::string("Example:\n  ") + example + "\n" + kExitStatus);
      subcommand->callback([this, run = std::move(run)] { chosen_ = run; });
      return subcommand;
    };
    add_verify_rul(part("rul", "Monte Carlo: random lives, monthly tests, estimates, forecasts until failure",
                        "sealwatch verify rul --asset config/assets/xt03-mv2.yaml --lives 1000 --out verification",
                        [this] { return run_verify_rul(verify_rul_); }));
    add_verify_mismatch(part("mismatch", "blind trial of explain: recordings with hidden physics, and who finds it",
                             "sealwatch verify mismatch --sets 40 --strata null,single --out trial",
                             [this] { return run_verify_mismatch(verify_mismatch_); }));
    CLI::App* merge = part("merge", "put the shards of one run together: the same results as of a run in one piece",
                           "sealwatch verify merge shard1 shard2 --out verification",
                           [this] { return run_verify_merge(verify_merge_); });
    merge->add_option("directories", verify_merge_.directories, "the --out of each shard")->required();
    merge->add_option("--out", verify_merge_.directory, "directory for the results (made if absent)")->required();
    merge->add_flag("--json", verify_merge_.json, "machine-readable result (schema sealwatch.verification/1)");
  }

  void add_verify_mismatch(CLI::App* trial) {
    VerifyMismatchOptions& o = verify_mismatch_;
    trial->add_option("--out", o.directory, "directory for records and results (made if absent)")->required();
    trial->add_option("--sets", o.sets, "sets of each stratum")->check(CLI::Range(0, 100000))->capture_default_str();
    trial
        ->add_option(
            "--strata", o.strata,
            "null, single, pair, outside, sensor, source_sensors, concealed, inseparable, nominal_only, asset_file "
            "(default: all)")
        ->delimiter(',');
    trial->add_option("--seed", o.seed, "of the first set; the next has the next")
        ->check(not_negative)
        ->capture_default_str();
    trial->add_option("--threads", o.threads, "0: one for each core")->check(CLI::Range(0, 256))->capture_default_str();
    trial->add_option("--shard", o.shard, "k/n: only this part of the sets")->capture_default_str();
    trial->add_option("--from", o.from, "directories of other shards, whose sets are counted too");
    trial->add_flag("--no-controls", o.without_controls, "only the analysis itself");
    trial->add_flag("--seal", o.seal, "run nothing: write the hash of the sets' labels to sealed.txt");
    trial->add_flag("--resume", o.resume, "go on with an interrupted run in --out");
    trial->add_flag("--json", o.json, "machine-readable result (schema sealwatch.mismatch_trial/1)");
  }

  void add_verify_rul(CLI::App* rul) {
    VerifyRulOptions& o = verify_rul_;
    rul->add_option("--asset", o.asset_file, "asset file")->required()->check(an_asset_file, "FILE");
    rul->add_option("--out", o.directory, "directory for records and results (made if absent)")->required();
    rul->add_option("--lives", o.lives, "number of random lives")->capture_default_str();
    rul->add_option("--seed", o.seed, "same seed, same results")->check(not_negative)->capture_default_str();
    rul->add_option("--months", o.months, "months of service")->capture_default_str();
    rul->add_option("--rate", o.sample_rate_Hz, "samples a second")->capture_default_str();
    rul->add_option("--threads", o.threads, "0: one for each core")->check(CLI::Range(0, 256))->capture_default_str();
    rul->add_option("--shard", o.shard, "k/n: only this part of the lives, for `verify merge`")->capture_default_str();
    rul->add_option("--truth", o.truth, "circuit, actuator (nine-state bench) or condition (no test is simulated)")
        ->capture_default_str();
    rul->add_option("--forecaster", o.forecasters, "METHOD or METHOD:MONTHS, several times (default: all)");
    rul->add_option("--degradation", o.degradation,
                    "published_ln_t (default), published_t, bench, or NAME=NUMBER; several");
    rul->add_option("--missing", o.missing_share, "share of the months without a test")->capture_default_str();
    rul->add_option("--cut", o.cut_share, "share of the tests that are cut short")->capture_default_str();
    rul->add_option("--scenario", o.scenarios,
                    "reference, outliers, missing, aborted, replaced, load_change, contamination; several with commas, "
                    "or all: one table of them")
        ->delimiter(',');
    rul->add_flag("--direct", o.direct, "recordings go to the estimator directly, not through the first two layers");
    rul->add_flag("--resume", o.resume, "go on with an interrupted run in --out");
    rul->add_flag("--json", o.json, "machine-readable result (schema sealwatch.verification/1)");
  }

  void add_explain() {
    CLI::App* explain =
        command("explain", "say where recordings and simulation differ, by what physics, and whether adding it helps",
                "sealwatch explain --asset asset.yaml --fit fit_*.csv --holdout holdout_*.csv --out found",
                [this] { return run_explain(explain_); });
    explain->add_option("--asset", explain_.asset_file, "asset file")->required()->check(an_asset_file, "FILE");
    explain->add_option("--fit", explain_.fit, "recordings to fit: tests that differ in load, speed or profile")
        ->required();
    explain->add_option("--holdout", explain_.holdout,
                        "recordings kept aside to prove it on (default: each fitted one is left out in turn)");
    explain
        ->add_option("--out", explain_.directory,
                     "directory for report.json, report.html and asset.explained.yaml (made if absent)")
        ->required();
    explain->add_option("--seed", explain_.seed, "same seed, same report")->check(not_negative)->capture_default_str();
    explain->add_option("--threads", explain_.threads, "threads to compute with")
        ->check(CLI::Range(1, 256))
        ->capture_default_str();
    explain->add_flag("--json", explain_.json, "the report (schema sealwatch.mismatch/1) on standard output");
  }

  void add_live() {
    CLI::App* replay =
        command("replay", "play recorded tests through the six services, or --offline in process",
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
                     "asset file: all recordings are of this asset; offline also in place of the configured one")
        ->check(an_asset_file, "FILE");
    replay->add_option("--results", replay_.results_directory,
                       "write every message there, a JSON line each, a file a topic");
    replay->add_option("--page", replay_.page,
                       "HTML file to write at the end: forecast of each asset, history, decision, reasons");
    replay->add_flag("--offline", replay_.offline, "without DDS and services: the same layers in this process");
    replay->add_flag("--with-services", replay_.with_services, "start the six services for the time of the replay")
        ->excludes("--offline");
    replay->add_option("--state", replay_.state_directory,
                       "state directory of those services instead of the configuration's");
    replay->add_flag("--json", replay_.json, "advisories and the last forecasts as JSON lines on standard output");
    replay->add_flag("--quiet", replay_.quiet, "only the final screen");

    CLI::App* watch = command("watch", "show any topic, live", "sealwatch watch advisory remaining_life",
                              [this] { return run_watch(watch_); });
    add_config(watch, watch_.config);
    watch->add_option("topics", watch_.topics, "topics by name, service_status among them (default: all but samples)");
    watch->add_option("--asset", watch_.asset_id, "only this asset");
    watch->add_option("--seconds", watch_.seconds, "stop after this time (default: until interrupted)")
        ->check(not_negative);
    watch->add_flag("--json", watch_.json, "one JSON object a line");

    CLI::App* up = command("up", "start the six services here and keep them running", "sealwatch up --config config",
                           [this] { return run_up(up_); });
    add_config(up, up_.config);
    up->add_option("--state", up_.state_directory, "state directory instead of the configuration's");

    CLI::App* status = command("status", "what the services are doing and the last word on every asset",
                               "sealwatch status", [this] { return run_status(status_); });
    add_config(status, status_.config);
    status->add_option("--seconds", status_.seconds, "how long to listen")
        ->check(CLI::Range(0.5, 60.0))
        ->check(a_number)
        ->capture_default_str();
    status->add_flag("--json", status_.json, "machine-readable result (schema sealwatch.status/1)");
  }

  void add_show() {
    CLI::App* show = command("show", "a message by its id, and what it was concluded from, down to the waveform",
                             "sealwatch show XT03-MV2 --state demo/state", [this] { return run_show(show_); });
    add_config(show, show_.config);
    show->add_option("id", show_.id, "message id, or a test's PST id, or an asset id for its newest advisory")
        ->required();
    show->add_option("--state", show_.state_directory,
                     "state directory of the services, which need not run, instead of the configuration's");
    show->add_option("--csv", show_.csv, "file to write the waveform of the test to, as a recording");
    show->add_flag("--json", show_.json, "machine-readable result (schema sealwatch.message/1): the message in full");
  }

  void add_operator() {
    CLI::App* acknowledge = command("acknowledge", "tell the system that an advisory has been seen",
                                    "sealwatch acknowledge XT03-MV2 ADVISORY_ID --by 'J. Silva'",
                                    [this] { return run_acknowledge(acknowledge_); });
    add_config(acknowledge, acknowledge_.config);
    acknowledge->add_option("asset", acknowledge_.asset_id, "asset id")->required();
    acknowledge->add_option("advisory", acknowledge_.advisory_id, "advisory id as `watch advisory --json` shows it")
        ->required();
    acknowledge->add_option("--by", acknowledge_.by, "who")->required();
    acknowledge->add_option("--remark", acknowledge_.remark, "free text");

    CLI::App* replaced = command(
        "replaced", "tell the system that an actuator or its seal was replaced: histories start anew",
        "sealwatch replaced XT03-MV2 --at 2018-05-02 --by 'J. Silva'", [this] { return run_replaced(replaced_); });
    add_config(replaced, replaced_.config);
    replaced->add_option("asset", replaced_.asset_id, "asset id")->required();
    replaced->add_option("--at", replaced_.at, "UTC time of the replacement")->required();
    replaced->add_option("--what", replaced_.what, "actuator or seal")
        ->check(CLI::IsMember({"actuator", "seal"}))
        ->capture_default_str();
    replaced->add_option("--by", replaced_.by, "who")->required();
    replaced->add_option("--remark", replaced_.remark, "free text");
  }

  void add_accept() {
    CLI::App* accept = command("accept",
                               "let the services simulate with the model that the mismatch analysis explained, or "
                               "--revoke it",
                               "sealwatch accept --asset-id XT03-MV2 --discrepancy ID --by 'J. Silva'",
                               [this] { return run_accept(accept_); });
    add_config(accept, accept_.config);
    accept->add_option("--asset-id", accept_.asset_id, "asset id")->required();
    accept->add_option("--discrepancy", accept_.discrepancy_id, "id of the model_discrepancy, as `status` shows it")
        ->required();
    accept->add_flag("--revoke", accept_.revoke, "back to the model of the asset's file");
    accept->add_option("--by", accept_.by, "who")->required();
    accept->add_option("--remark", accept_.remark, "free text");
  }

  void add_configuration() {
    CLI::App* config = app_.add_subcommand("config", "look at the configuration");
    config->require_subcommand(1);
    CLI::App* check =
        config->add_subcommand("check", "validate the whole configuration and list every fault with file and line");
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
  std::function<int()> chosen_ = [] { return kBadInput; };
  SimulateOptions simulate_;
  FitOptions fit_;
  ExplainOptions explain_;
  ForecastOptions forecast_;
  ValidateOptions validate_;
  VerifyMismatchOptions verify_mismatch_;
  VerifyRulOptions verify_rul_;
  VerifyMergeOptions verify_merge_;
  ReplayOptions replay_;
  WatchOptions watch_;
  ShowOptions show_;
  UpOptions up_;
  StatusOptions status_;
  AcknowledgeOptions acknowledge_;
  ReplacedOptions replaced_;
  AcceptOptions accept_;
  ConfigCheckOptions config_check_;
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

// Arguments of the commands that analyse recordings, models and histories.
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "services/cli/arguments.hpp"
#include "services/cli/command_line.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/session.hpp"
#include "services/cli/supervisor.hpp"
#include "services/verification/command/arguments.hpp"

namespace sealwatch::cli {
namespace {

void add_simulate(CommandLine& line) {
  const auto options = std::make_shared<SimulateOptions>();
  CLI::App* simulate =
      line.command("simulate", "simulate tests on the virtual bench, or any plant's outputs",
                   "sealwatch simulate --asset config/assets/xt03-mv2.yaml --ageing --months 108 --out recordings\n"
                   "  sealwatch simulate --asset valve-7.yaml --input inputs.csv --out simulated\n"
                   "  sealwatch simulate --asset valve-7.yaml --input test.csv --noise --ageing --months 60 --out life",
                   [options] { return run_simulate(*options); });
  simulate->add_option("--asset", options->asset_file, "asset file")->required()->check(an_asset_file, "FILE");
  simulate->add_option("--out", options->directory, "directory for the recordings (created if absent)")->required();
  simulate->add_option("--months", options->months, "number of monthly tests")
      ->check(CLI::Range(1, 600))
      ->capture_default_str();
  simulate->add_option("--start", options->start, "UTC time of installation; the first test is a month later")
      ->capture_default_str();
  simulate->add_option("--seed", options->seed, "same seed, same recordings")
      ->check(not_negative)
      ->capture_default_str();
  simulate->add_option("--rate", options->sample_rate_Hz, "samples a second")
      ->check(CLI::Range(10.0, 5000.0))
      ->check(a_number)
      ->capture_default_str();
  simulate->add_option("--condition", options->condition, "condition theta at the first test")
      ->check(CLI::Range(0.05, 1.2))
      ->check(a_number)
      ->capture_default_str();
  simulate->add_flag("--ageing", options->ageing,
                     "age the wearing part month by month, until it fails or the last of --months");
  simulate->add_option("--missing", options->missing_share, "share of months without a test")
      ->check(CLI::Range(0.0, 0.9))
      ->check(a_number)
      ->capture_default_str();
  simulate->add_option("--cut", options->cut_share, "share of tests cut short")
      ->check(CLI::Range(0.0, 1.0))
      ->check(a_number)
      ->capture_default_str();
  CLI::Option* input = simulate->add_option(
      "--input", options->inputs,
      "files with the inputs of the asset's plant: simulates it at their samples instead of the bench's tests; their "
      "outputs, if any, set the initial state");
  simulate->add_flag("--noise", options->noise, "with --input: add the sensors' noise")->needs(input);
  CommandLine::add_map(simulate, options->map_file);
}

void add_fit(CommandLine& line) {
  const auto options = std::make_shared<FitOptions>();
  CLI::App* fit = line.command("fit", "estimate parameters from recorded tests (by prediction-error minimisation)",
                               "sealwatch fit --asset config/assets/xt03-mv2.yaml 2016-03.csv --json",
                               [options] { return run_fit(*options); });
  CommandLine::one_means(fit, "the fit is not admissible, and says why");
  fit->add_option("--asset", options->asset_file, "asset file")->required()->check(an_asset_file, "FILE");
  fit->add_option("recordings", options->recordings, "recordings, fitted jointly (CSV or MAT)")->required();
  CommandLine::add_map(fit, options->map_file);
  fit->add_option("--model", options->model,
                  "cylinder_circuit, or the asset's whole model (default: the best the channels allow)");
  fit->add_option(
         "--time-limit", options->time_limit_s,
         "stop after this many seconds with the best answer so far, marked as not converged (default: no limit)")
      ->check(CLI::PositiveNumber);
  fit->add_option("--threads", options->threads, "recordings that are simulated at once")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  fit->add_flag("--json", options->json, "machine-readable result (schema sealwatch.fit/1)");
}

void add_validate(CommandLine& line) {
  const auto options = std::make_shared<ValidateOptions>();
  CLI::App* validate =
      line.command("validate", "compare simulation with recordings, channel by channel",
                   "sealwatch validate --asset config/assets/bench_eha.yaml stroke1.csv stroke2.csv --out validation\n"
                   "  sealwatch validate --simulated sim.csv recorded.csv --page trace.html",
                   [options] { return run_validate(*options); });
  CommandLine::one_means(validate, "simulation and recording differ");
  validate->add_option("--asset", options->asset_file, "asset file")->check(an_asset_file, "FILE");
  validate->add_option("recordings", options->recordings, "recordings (CSV or MAT)")->required();
  validate->add_option("--out", options->directory, "directory for the report (created if absent)");
  CLI::Option* simulated = validate->add_option(
      "--simulated", options->simulated, "trace of your own simulation, to compare with one recording without a model");
  validate->add_option("--page", options->page, "with --simulated: HTML file to write")->needs(simulated);
  validate
      ->add_option("--input", options->inputs,
                   "with --simulated: channels that drive the simulation (default: the asset's)")
      ->needs(simulated);
  CommandLine::add_map(validate, options->map_file);
  validate->add_flag("--fit", options->fit, "estimate the asset's free parameters from these recordings first");
  validate->add_flag("--json", options->json,
                     "machine-readable result (schema sealwatch.validation/1, of a trace sealwatch.trace/1)");
}

void add_explain(CommandLine& line) {
  const auto options = std::make_shared<ExplainOptions>();
  CLI::App* explain =
      line.command("explain", "find, name and prove physics that the simulation lacks",
                   "sealwatch explain --asset asset.yaml --fit fit_*.csv --holdout holdout_*.csv --out found",
                   [options] { return run_explain(*options); });
  CommandLine::one_means(explain, "the verdict is undetermined");
  explain->add_option("--asset", options->asset_file, "asset file")->required()->check(an_asset_file, "FILE");
  explain->add_option("--fit", options->fit, "recordings to fit: tests that differ in load, speed or profile")
      ->required();
  explain->add_option("--holdout", options->holdout,
                      "held-out recordings for the proof (default: each fitted one is left out in turn)");
  explain
      ->add_option("--out", options->directory,
                   "directory for report.json, report.html and asset.explained.yaml (created if absent)")
      ->required();
  CommandLine::add_map(explain, options->map_file);
  explain->add_option("--seed", options->seed, "same seed, same report")->check(not_negative)->capture_default_str();
  explain
      ->add_option("--time-limit", options->time_limit_s,
                   "stop after this many seconds with the best answer so far and a list of what was not tried")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  explain->add_option("--threads", options->threads, "threads to compute with")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  explain->add_flag("--json", options->json, "the report (schema sealwatch.mismatch/1) on standard output");
}

void add_forecast(CommandLine& line) {
  const auto options = std::make_shared<ForecastOptions>();
  CLI::App* forecast = line.command("forecast", "forecast the remaining useful life",
                                    "sealwatch forecast --asset XT03-MV2 --state demo/state --page forecast.html\n"
                                    "  sealwatch forecast --history history.csv --before 2019-06-01 --json",
                                    [options] { return run_forecast(*options); });
  CLI::Option* history = forecast->add_option(
      "--history", options->history_file,
      "CSV: time[iso8601],theta[1],theta_std[1] (or R_CL[Pa s/m3] with --asset); default: the services' journals");
  forecast
      ->add_option("--state", options->state_directory,
                   "state directory of the services (running or not), instead of the configuration's")
      ->excludes(history);
  forecast->add_option("--asset", options->asset,
                       "asset file: seal resistances and threshold; without --history also an asset's id");
  forecast->add_option("--before", options->before, "dates for which to give the probability of failure");
  forecast->add_option("--config", options->config,
                       "configuration file or directory: campaigns, costs and forecasters of the asset's site; "
                       "without --history as for other commands");
  forecast
      ->add_option("--costs", options->costs, "what replacements cost: PLANNED,AFTER_FAILURE,FAILED_MONTH,UNUSED_MONTH")
      ->delimiter(',');
  forecast->add_option("--page", options->page, "HTML file to write: advice, history, forecast, decision, reasons");
  forecast->add_option("--threshold", options->threshold, "seal condition below which it has failed")
      ->check(CLI::Range(0.0, 1.0))
      ->check(a_number)
      ->capture_default_str()
      ->each([options](const std::string&) { options->threshold_given = true; });
  forecast->add_flag("--json", options->json, "machine-readable result (schema sealwatch.forecast/1)");
}

void add_plant_import(CommandLine& line, CLI::App& plant) {
  const auto options = std::make_shared<PlantImportOptions>();
  CLI::App* unit = line.nested(plant, "import", "write a draft plant file for an FMU",
                               "sealwatch plant import model.fmu --out model.yaml",
                               [options] { return run_plant_import(*options); });
  unit->add_option("fmu", options->fmu, "FMU of FMI 2.0 or 3.0, for Linux on x86-64")->required();
  unit->add_option("--out", options->file, "plant file to write (YAML)")->required();
  unit->add_option("--interface", options->interface, "me or cs, if the unit offers both (default: me)")
      ->check(CLI::IsMember({"me", "cs"}));
  unit->add_option("--set", options->settings,
                   "NAME=VALUE: a parameter fixed before the run, such as a size or a file name")
      ->allow_extra_args(false);
}

void add_plant_export(CommandLine& line, CLI::App& plant) {
  const auto options = std::make_shared<PlantExportOptions>();
  CLI::App* back = line.nested(plant, "export", "write an asset's plant with its laws as an FMU",
                               "sealwatch plant export --asset report/asset.explained.yaml --fmu explained.fmu",
                               [options] { return run_plant_export(*options); });
  back->add_option("--asset", options->asset_file, "asset file")->required()->check(an_asset_file, "FILE");
  back->add_option("--fmu", options->fmu, "FMU to write (Model Exchange)")->required();
  back->add_option("--fmi", options->fmi, "FMI version (default: 2; an imported FMU keeps its own)")
      ->check(CLI::IsMember({2, 3}));
}

void add_plant_check(CommandLine& line, CLI::App& plant) {
  const auto options = std::make_shared<PlantCheckOptions>();
  CLI::App* check = line.nested(plant, "check", "show how a plant file is read, or every fault in it",
                                "sealwatch plant check config/plants/spring_return.yaml",
                                [options] { return run_plant_check(*options); });
  check->add_option("file", options->file, "the plant's YAML file")->required();
  check->add_flag("--json", options->json, "machine-readable result");
}

void add_plant_show(CommandLine& line, CLI::App& plant) {
  const auto options = std::make_shared<PlantShowOptions>();
  CLI::App* show = line.nested(plant, "show", "states, channels, parameters and elements of a plant",
                               "sealwatch plant show eha\n"
                               "  sealwatch plant show config/plants/spring_return.yaml --json",
                               [options] { return run_plant_show(*options); });
  show->add_option("plant", options->name, "eha, eha_switched, emps, cascaded_tanks, or a plant's YAML file")
      ->required();
  show->add_flag("--json", options->json, "machine-readable (schema sealwatch.plant/1)");
}

void add_plant(CommandLine& line) {
  CLI::App* plant = line.holder("plant", "check, import and export plants: text files and FMUs",
                                "sealwatch plant check config/plants/spring_return.yaml");
  add_plant_import(line, *plant);
  add_plant_export(line, *plant);
  add_plant_check(line, *plant);
  add_plant_show(line, *plant);
}

void add_laws(CommandLine& line) {
  const auto options = std::make_shared<LawsOptions>();
  CLI::App* laws = line.command("laws", "list the laws of physics that explain tries",
                                "sealwatch laws\n  sealwatch laws piston\n  sealwatch laws coulomb_friction --json",
                                [options] { return run_laws(*options); });
  laws->add_option("asked", options->asked, "a law's id, an element of a plant, or a kind of site (default: all)");
  laws->add_flag("--json", options->json, "machine-readable (schema sealwatch.laws/1)");
}

void add_fleet(CommandLine& line) {
  const auto options = std::make_shared<FleetFitOptions>();
  CLI::App* fleet = line.holder("fleet", "estimate a fleet's ageing constants from its histories",
                                "sealwatch fleet fit life1.csv life2.csv life3.csv");
  CLI::App* fit =
      line.nested(*fleet, "fit", "estimate ageing constants with uncertainty, for the forecasts' configuration",
                  "sealwatch fleet fit life1.csv life2.csv life3.csv", [options] { return run_fleet_fit(*options); });
  fit->add_option("histories", options->histories,
                  "one per life: CSV time[iso8601],theta[1],theta_std[1] (or R_CL[Pa s/m3] with --asset)")
      ->required();
  fit->add_option("--installed", options->installed,
                  "date of each seal's installation (default: a month before its first test)")
      ->delimiter(',');
  fit->add_option("--asset", options->asset_file, "asset file: seal resistances")->check(an_asset_file, "FILE");
  fit->add_flag("--json", options->json, "machine-readable result (schema sealwatch.fleet/1)");
}

void add_asset(CommandLine& line) {
  const auto options = std::make_shared<AssetNewOptions>();
  CLI::App* asset = line.holder("asset", "write an asset file from your own log",
                                "sealwatch asset new --from log.csv --out asset.yaml");
  CLI::App* fresh =
      line.nested(*asset, "new", "write an asset file with a channel map guessed from the log",
                  "sealwatch asset new --from log.csv --out asset.yaml", [options] { return run_asset_new(*options); });
  fresh->add_option("--from", options->log, "your log: CSV or other text in columns, MATLAB or HDF5")->required();
  fresh->add_option("--out", options->file, "asset file to write, with plots beside it (.html)")->required();
  fresh->add_option("--model", options->model, "built-in plant (default: best match to the columns), or a plant file");
  fresh->add_option("--id,--asset-id", options->asset_id, "asset id (default: the sidecar's, else the log's name)");
  fresh->add_flag("--yes", options->yes, "accept the guess without asking");
}

// Its work is done by a program of its own: whoever monitors actuators does not load the laboratory.
int run_laboratory(std::vector<char*> arguments) {
  const std::string program = program_path("sealwatch-verify");
  arguments.front() = const_cast<char*>(program.c_str());
  ::execvp(program.c_str(), arguments.data());
  complain(Error{.file = program,
                 .place = {},
                 .value = std::strerror(errno),
                 .rule = "cannot be run",
                 .advice = "it belongs beside sealwatch; `deploy/build.sh release` builds it"});
  return kInternalFailure;
}

void add_verify(CommandLine& line) {
  const auto options = std::make_shared<VerifyOptions>();
  CLI::App* verify = line.holder("verify", "verify estimates, forecasts and explanations against known truths",
                                 "sealwatch verify mismatch --help");
  add_verify_arguments(*verify, *options, [options, &line](VerifyPart) {
    line.choose([&line] { return run_laboratory(line.arguments()); });
  });
}

}  // namespace

void add_analysis(CommandLine& line) {
  line.begin_group("Analyse");
  for (const auto add : {&add_simulate, &add_fit, &add_validate, &add_explain, &add_forecast, &add_verify, &add_plant,
                         &add_laws, &add_fleet, &add_asset})
    add(line);
}

}  // namespace sealwatch::cli

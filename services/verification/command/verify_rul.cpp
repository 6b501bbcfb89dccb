#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <thread>

#include "sealwatch/core/file.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/session.hpp"
#include "services/cli/terminal.hpp"
#include "services/verification/command/options.hpp"
#include "services/verification/command/verify_results.hpp"
#include "services/verification/command/verify_scenarios.hpp"
#include "services/verification/lives/run_lives.hpp"

namespace sealwatch::cli {
namespace {

using verification::LifeCollection;
using verification::LifeSimulator;
using verification::LifeStore;
using verification::RunOutcome;
using verification::Scenario;
using verification::Summary;
using verification::VerificationSetting;

int refused(const Error& error) {
  complain(error);
  return kBadInput;
}

Result<VerificationSetting> setting_of(const VerifyRulOptions& options, const AssetConfig& asset, Scenario scenario) {
  const auto truth = verification::truth_named(options.truth);
  if (!truth) return fail(truth.error());
  VerificationSetting setting{.asset = asset,
                              .lives = options.lives,
                              .seed = options.seed,
                              .months = options.months,
                              .truth = *truth,
                              .sample_rate_Hz = options.sample_rate_Hz,
                              .through_layers = !options.direct,
                              .missing_share = options.missing_share,
                              .cut_share = options.cut_share,
                              .scenario = scenario};
  for (const std::string& name : options.forecasters) {
    auto forecaster = verification::forecaster_named(name);
    if (!forecaster) return fail(forecaster.error());
    setting.forecasters.push_back(std::move(*forecaster));
  }
  if (setting.forecasters.empty()) setting.forecasters = verification::all_forecasters();
  for (const std::string& assignment : options.degradation)
    if (const Status set = verification::set_constant(setting.degradation, assignment); !set) return fail(set.error());
  return setting;
}

rusage usage_so_far() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage;
}

double cpu_seconds(const rusage& usage) {
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

Status write_text(const std::string& folder, const std::string& name, const std::string& text) {
  return write_file((std::filesystem::path(folder) / name).string(), text);
}

/// What the run cost: not part of its results.
Status write_cost(const VerifyRulOptions& options, const std::string& folder, int threads, const RunOutcome& outcome,
                  double seconds, double processor_seconds_before) {
  const rusage usage = usage_so_far();
  constexpr double kMegabytes = 1.0 / 1024.0;  // of kilobytes
  const nlohmann::ordered_json json = {{"shard", options.shard},
                                       {"threads", threads},
                                       {"simulated_lives", outcome.simulated},
                                       {"found_lives", outcome.found_before},
                                       {"tests", outcome.tests},
                                       {"seconds", seconds},
                                       {"processor_seconds", cpu_seconds(usage) - processor_seconds_before},
                                       {"largest_memory_MB", static_cast<double>(usage.ru_maxrss) * kMegabytes}};
  return write_text(folder, "cost.json", json.dump(1) + "\n");
}

/// Writes report.html and results.json.
Result<Summary> conclude(std::vector<LifeStore> stores, const std::string& folder) {
  const auto lives = LifeCollection::make(std::move(stores));
  if (!lives) return fail(lives.error());
  std::error_code problem;
  std::filesystem::create_directories(folder, problem);  // what fails shows when it is written to
  auto summary = verification::summarise(lives->size(), lives->values_of("method"),
                                         [&lives](std::uint32_t life) { return lives->read(life); });
  if (!summary) return summary;
  const Result<std::string> page = verification_page(*lives, *summary);
  if (!page) return fail(page.error());
  if (const Status written = write_text(folder, "results.json", verification_json(*lives, *summary)); !written)
    return fail(written.error());
  if (const Status written = write_text(folder, "report.html", *page); !written) return fail(written.error());
  return summary;
}

int print_one(const Summary& summary, const std::string& folder, bool as_json) {
  if (as_json) {
    std::ifstream results(std::filesystem::path(folder) / "results.json", std::ios::binary);
    std::printf("%s", std::string(std::istreambuf_iterator<char>(results), {}).c_str());
  } else {
    std::printf("%s\nin %s: report.html, results.json\n", verification_table(summary).c_str(), folder.c_str());
  }
  return kOk;
}

int print_scenarios(const std::vector<ScenarioSummary>& scenarios, const std::string& folder, bool as_json) {
  const std::string json = scenario_json(scenarios);
  for (const auto& [name, text] : {std::pair{"scenarios.json", json}, {"scenarios.html", scenario_page(scenarios)}})
    if (const Status written = write_text(folder, name, text); !written) return refused(written.error());
  std::printf("%s", as_json ? json.c_str() : scenario_table(scenarios).c_str());
  if (!as_json)
    std::printf("\nin %s: scenarios.html, scenarios.json; in a folder for each scenario: report.html, results.json\n",
                folder.c_str());
  return kOk;
}

/// None: the run was not concluded, and `status` says why.
struct ScenarioRun {
  int status = kOk;
  std::optional<Summary> summary;
};

ScenarioRun run_scenario(const VerifyRulOptions& options, const AssetConfig& asset, Scenario scenario,
                         const std::string& folder) {
  const auto bad = [](const Error& error) { return ScenarioRun{.status = refused(error), .summary = {}}; };
  auto setting = setting_of(options, asset, scenario);
  if (!setting) return bad(setting.error());
  const auto shard = verification::shard_named(options.shard);
  if (!shard) return bad(shard.error());
  const auto simulator = LifeSimulator::make(std::move(*setting));
  if (!simulator) return bad(simulator.error());
  const auto store = LifeStore::create(folder, describe(simulator->setting()), options.resume);
  if (!store) return bad(store.error());

  const std::vector<std::uint32_t> own = verification::lives_of(*shard, options.lives);
  const int threads =
      options.threads > 0 ? options.threads : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  const double processor_seconds_before = cpu_seconds(usage_so_far());  // of the scenarios before
  const auto begin = std::chrono::steady_clock::now();
  const auto elapsed = [begin] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  Progress progress("verify rul, " + std::string(name_of(scenario)), own.size(), "lives");
  const auto outcome = run_lives(*simulator, *store, own, threads, [&](std::size_t done) {
    progress.show(done, number(elapsed(), 3) + " s");
    return !interrupted();
  });
  progress.finish();
  if (!outcome) return bad(outcome.error());
  if (const Status written = write_cost(options, folder, threads, *outcome, elapsed(), processor_seconds_before);
      !written)
    return bad(written.error());
  if (outcome->interrupted) {
    std::fprintf(stderr, "interrupted after %zu of %zu lives; --resume goes on\n",
                 outcome->found_before + outcome->simulated, own.size());
    return {.status = kAnswerIsNo, .summary = {}};
  }
  if (shard->of > 1) {
    std::printf("shard %s: %zu lives in %s; `sealwatch verify merge` puts the shards together\n", options.shard.c_str(),
                own.size(), folder.c_str());
    return {};
  }
  auto summary = conclude({*store}, folder);
  if (!summary) return bad(summary.error());
  return {.status = kOk, .summary = std::move(*summary)};
}

Result<std::vector<Scenario>> scenarios_of(const std::vector<std::string>& names) {
  if (names == std::vector<std::string>{"all"}) return verification::all_scenarios();
  std::vector<Scenario> scenarios;
  for (const std::string& name : names) {
    const auto scenario = verification::scenario_named(name);
    if (!scenario) return fail(scenario.error());
    if (std::find(scenarios.begin(), scenarios.end(), *scenario) == scenarios.end()) scenarios.push_back(*scenario);
  }
  if (scenarios.empty()) scenarios.push_back(Scenario::reference);
  return scenarios;
}

std::string inside(const std::string& folder, Scenario scenario) {
  return (std::filesystem::path(folder) / name_of(scenario)).string();
}

}  // namespace

int run_verify_rul(const VerifyRulOptions& options) {
  const std::optional<AssetConfig> asset = load_asset_or_explain(options.asset_file);
  if (!asset) return kBadInput;
  const auto scenarios = scenarios_of(options.scenarios);
  if (!scenarios) return refused(scenarios.error());
  catch_interrupts();
  if (scenarios->size() == 1) {
    const ScenarioRun run = run_scenario(options, *asset, scenarios->front(), options.directory);
    return run.summary ? print_one(*run.summary, options.directory, options.json) : run.status;
  }
  std::vector<ScenarioSummary> summaries;
  for (const Scenario scenario : *scenarios) {
    ScenarioRun run = run_scenario(options, *asset, scenario, inside(options.directory, scenario));
    if (run.status != kOk) return run.status;
    if (run.summary) summaries.push_back({std::string(name_of(scenario)), std::move(*run.summary)});
  }
  return summaries.empty() ? kOk : print_scenarios(summaries, options.directory, options.json);
}

namespace {

Result<Summary> merge(const std::vector<std::string>& directories, const std::string& folder) {
  std::vector<LifeStore> stores;
  for (const std::string& directory : directories) {
    auto store = LifeStore::open(directory);
    if (!store) return fail(store.error());
    stores.push_back(std::move(*store));
  }
  return conclude(std::move(stores), folder);
}

/// Scenarios that the shards have a folder for each.
std::vector<Scenario> scenarios_in(const std::string& directory) {
  std::vector<Scenario> found;
  if (LifeStore::open(directory)) return found;
  for (const Scenario scenario : verification::all_scenarios())
    if (LifeStore::open(inside(directory, scenario))) found.push_back(scenario);
  return found;
}

}  // namespace

int run_verify_merge(const VerifyMergeOptions& options) {
  const std::vector<Scenario> scenarios = scenarios_in(options.directories.front());
  if (scenarios.empty()) {
    const auto summary = merge(options.directories, options.directory);
    return summary ? print_one(*summary, options.directory, options.json) : refused(summary.error());
  }
  std::vector<ScenarioSummary> summaries;
  for (const Scenario scenario : scenarios) {
    std::vector<std::string> parts;
    for (const std::string& directory : options.directories) parts.push_back(inside(directory, scenario));
    auto summary = merge(parts, inside(options.directory, scenario));
    if (!summary) return refused(summary.error());
    summaries.push_back({std::string(name_of(scenario)), std::move(*summary)});
  }
  return print_scenarios(summaries, options.directory, options.json);
}

}  // namespace sealwatch::cli

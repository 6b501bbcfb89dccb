#include <sys/resource.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "services/cli/commands.hpp"
#include "services/cli/session.hpp"
#include "services/cli/terminal.hpp"
#include "services/cli/verify.hpp"
#include "services/cli/verify_results.hpp"
#include "services/common/verification/run_lives.hpp"

namespace sealwatch::cli {
namespace {

using verification::LifeCollection;
using verification::LifeSimulator;
using verification::LifeStore;
using verification::RunOutcome;
using verification::VerificationSetting;

int refused(const Error& error) {
  complain(error);
  return kBadInput;
}

Result<VerificationSetting> setting_of(const VerifyRulOptions& options, const AssetConfig& asset) {
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
                              .cut_share = options.cut_share};
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

double cpu_seconds(const rusage& usage) {
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

Status write_text(const std::string& folder, const std::string& name, const std::string& text) {
  const std::string file = (std::filesystem::path(folder) / name).string();
  std::ofstream stream(file, std::ios::binary | std::ios::trunc);
  stream << text;
  stream.close();
  if (stream) return {};
  return fail(Error{.file = file, .place = {}, .value = {}, .rule = "cannot be written", .advice = {}});
}

/// What the run cost: not part of its results.
Status write_cost(const VerifyRulOptions& options, int threads, const RunOutcome& outcome, double seconds) {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  constexpr double kMegabytes = 1.0 / 1024.0;  // of kilobytes
  const nlohmann::ordered_json json = {{"shard", options.shard},
                                       {"threads", threads},
                                       {"simulated_lives", outcome.simulated},
                                       {"found_lives", outcome.found_before},
                                       {"tests", outcome.tests},
                                       {"seconds", seconds},
                                       {"processor_seconds", cpu_seconds(usage)},
                                       {"largest_memory_MB", static_cast<double>(usage.ru_maxrss) * kMegabytes}};
  return write_text(options.directory, "cost.json", json.dump(1) + "\n");
}

int conclude(const LifeCollection& lives, const std::string& folder, bool as_json) {
  const auto summary = verification::summarise(lives.size(), lives.values_of("method"),
                                               [&lives](std::uint32_t life) { return lives.read(life); });
  if (!summary) return refused(summary.error());
  const std::string json = verification_json(lives, *summary);
  const Result<std::string> page = verification_page(lives, *summary);
  if (!page) return refused(page.error());
  if (const Status written = write_text(folder, "results.json", json); !written) return refused(written.error());
  if (const Status written = write_text(folder, "report.html", *page); !written) return refused(written.error());
  std::printf("%s", as_json ? json.c_str() : verification_table(*summary).c_str());
  if (!as_json) std::printf("\nin %s: report.html, results.json\n", folder.c_str());
  return kOk;
}

int conclude_run(const VerifyRulOptions& options, const LifeStore& store) {
  auto lives = LifeCollection::make({store});
  if (!lives) return refused(lives.error());
  return conclude(*lives, options.directory, options.json);
}

}  // namespace

int run_verify_rul(const VerifyRulOptions& options) {
  const std::optional<AssetConfig> asset = load_asset_or_explain(options.asset_file);
  if (!asset) return kBadInput;
  auto setting = setting_of(options, *asset);
  if (!setting) return refused(setting.error());
  const auto shard = verification::shard_named(options.shard);
  if (!shard) return refused(shard.error());
  const auto simulator = LifeSimulator::make(std::move(*setting));
  if (!simulator) return refused(simulator.error());
  const auto store = LifeStore::create(options.directory, describe(simulator->setting()), options.resume);
  if (!store) return refused(store.error());

  const std::vector<std::uint32_t> own = verification::lives_of(*shard, options.lives);
  const int threads = options.threads > 0 ? options.threads : std::max(1U, std::thread::hardware_concurrency());
  const auto begin = std::chrono::steady_clock::now();
  const auto elapsed = [begin] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  catch_interrupts();
  Progress progress("verify rul, lives", own.size());
  const auto outcome = run_lives(*simulator, *store, own, threads, [&](std::size_t done) {
    progress.show(done, number(elapsed(), 3) + " s");
    return !interrupted();
  });
  progress.finish();
  if (!outcome) return refused(outcome.error());
  if (const Status written = write_cost(options, threads, *outcome, elapsed()); !written)
    return refused(written.error());
  if (outcome->interrupted) {
    std::fprintf(stderr, "interrupted after %zu of %zu lives; --resume goes on\n",
                 outcome->found_before + outcome->simulated, own.size());
    return kAnswerIsNo;
  }
  if (shard->of == 1) return conclude_run(options, *store);
  std::printf("shard %s: %zu lives in %s; `sealwatch verify merge` puts the shards together\n", options.shard.c_str(),
              own.size(), options.directory.c_str());
  return kOk;
}

int run_verify_merge(const VerifyMergeOptions& options) {
  std::vector<LifeStore> stores;
  for (const std::string& directory : options.directories) {
    auto store = LifeStore::open(directory);
    if (!store) return refused(store.error());
    stores.push_back(std::move(*store));
  }
  const auto lives = LifeCollection::make(std::move(stores));
  if (!lives) return refused(lives.error());
  std::error_code problem;
  std::filesystem::create_directories(options.directory, problem);
  return conclude(*lives, options.directory, options.json);
}

}  // namespace sealwatch::cli

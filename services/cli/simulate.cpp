// `sealwatch simulate`: recordings of the virtual bench, with the truth beside them.
#include <algorithm>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "services/cli/commands.hpp"
#include "services/cli/session.hpp"
#include "services/cli/simulated_life.hpp"
#include "services/cli/terminal.hpp"
#include "services/common/recording/recording_file.hpp"

namespace sealwatch::cli {
namespace {

/// Digits of a written sample: two more than the sensors' noise needs.
constexpr int kSignificantDigits = 9;

}  // namespace

std::optional<bench::LifeSetting> life_of(const SimulateOptions& options) {
  Result<UtcTime> start = parse_utc(options.start);
  if (!start) {
    start.error().place = "--start";
    complain(start.error());
    return std::nullopt;
  }
  const UtcTime last_day = parse_utc("2250-12-31").value();
  if (months_between(*start, last_day) < options.months + 1.0) {
    complain(Error{.file = {},
                   .place = "--start",
                   .value = options.start,
                   .rule = "with " + std::to_string(options.months) + " months leads past " + format_date(last_day),
                   .advice = "start earlier: times are counted in nanoseconds, which end soon after"});
    return std::nullopt;
  }
  bench::LifeSetting life;
  life.seed = options.seed;
  life.months = options.months;
  life.installed = *start;
  life.missing_share = options.missing_share;
  life.cut_share = options.cut_share;
  life.degradation.initial_condition = options.condition;
  if (!options.ageing) {
    life.degradation.initial_gamma = {0.0, 0.0};
    life.degradation.steepening_limit = {0.0, 0.0};
    life.degradation.irregularity = {0.0, 0.0};
  }
  return life;
}

std::string truth_line(const ConditionSetting& condition, const bench::PlannedTest& test,
                       const std::string& recording) {
  nlohmann::ordered_json truth = {{"recording", recording},
                                  {"month", test.month},
                                  {"start_time", format_utc(test.start_time)},
                                  {"theta", test.condition}};
  std::string key = condition.parameter + "_" + condition.unit;  // R_CL_Pa_s_m3
  std::ranges::replace_if(
      key, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; }, '_');
  truth[key] = test.resistance_Pa_s_m3;
  truth["load_factor"] = test.load_factor;
  truth["recorded_share"] = test.recorded_share;
  return truth.dump();
}

std::vector<bench::PlannedTest> plan_of(const AssetConfig& asset, const bench::LifeSetting& life) {
  const Result<std::vector<bench::PlannedTest>> plan = bench::plan_life(asset, life);
  if (!plan) return complain(plan.error()), std::vector<bench::PlannedTest>{};
  if (plan->empty())  // a life ends at the threshold
    complain(Error{.file = {},
                   .place = "--condition",
                   .value = number(life.degradation.initial_condition, 3),
                   .rule = "is not above the asset's threshold " + number(asset.condition->threshold, 3) +
                           ": what wears has failed before its first test",
                   .advice = {}});
  return *plan;
}

void say_life(const std::vector<bench::PlannedTest>& plan, const std::string& directory) {
  const bench::PlannedTest& last = plan.back();
  std::printf("%s in %s, %s to %s; condition %s at the last (the truth is in truth.jsonl)\n",
              count_of(plan.size(), "month").c_str(), directory.c_str(), format_date(plan.front().start_time).c_str(),
              format_date(last.start_time).c_str(), percent(last.condition).c_str());
}

namespace {

Status write_life(const AssetConfig& asset, const bench::LifeSetting& life, const SimulateOptions& options,
                  const std::vector<bench::PlannedTest>& plan) {
  const std::filesystem::path folder = options.directory;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  std::ofstream truth(folder / "truth.jsonl");
  if (!truth)
    return fail(Error{.file = folder.string(), .place = {}, .value = {}, .rule = "cannot be written to", .advice = {}});
  bench::TestSetting setting;
  setting.sample_rate_Hz = options.sample_rate_Hz;
  Progress progress("simulate", plan.size(), "months");
  for (std::size_t k = 0; k < plan.size(); ++k) {
    progress.show(k, format_date(plan[k].start_time));
    if (plan[k].recorded_share <= 0.0) {
      truth << truth_line(*asset.condition, plan[k], "") << "\n";
      continue;
    }
    const Result<Recording> recording = bench::simulate_planned(asset, life, plan[k], setting);
    if (!recording) return fail(recording.error());
    std::string name = recording->recording_id;
    std::ranges::replace(name, '/', '_');  // of an asset's id, like XT03/MV2
    const std::string file = (folder / (name + ".csv")).string();
    if (Status written = write_recording_csv(*recording, file, kSignificantDigits); !written) return written;
    truth << truth_line(*asset.condition, plan[k], name) << "\n";
  }
  if (!truth.flush())
    return fail(Error{.file = (folder / "truth.jsonl").string(),
                      .place = {},
                      .value = {},
                      .rule = "cannot be written to",
                      .advice = "make room"});
  return {};
}

}  // namespace

int run_simulate(const SimulateOptions& options) {
  if (!options.inputs.empty()) return run_simulate_input(options);
  const std::optional<AssetConfig> asset = load_asset_or_explain(options.asset_file);
  const std::optional<bench::LifeSetting> life = life_of(options);
  if (!asset || !life) return kBadInput;
  if (const auto plant = find_plant(asset->model); plant && !(*plant)->file.empty()) {
    complain(Error{.file = options.asset_file,
                   .place = "model",
                   .value = asset->model,
                   .rule = "is a plant of your own, for which there is no virtual bench",
                   .advice = "give a file with the inputs of its test with --input"});
    return kBadInput;
  }
  const std::vector<bench::PlannedTest> plan = plan_of(*asset, *life);
  if (plan.empty()) return kBadInput;
  if (const Status written = write_life(*asset, *life, options, plan); !written) {
    complain(written.error());
    return kBadInput;
  }
  say_life(plan, options.directory);
  return kOk;
}

}  // namespace sealwatch::cli

// `sealwatch simulate --input`: the asset's plant, driven by what a file says of its inputs.
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>
#include <random>

#include "sealwatch/model/simulation.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/recordings.hpp"
#include "services/cli/session.hpp"
#include "services/cli/simulated_life.hpp"
#include "services/common/model/first_value.hpp"
#include "services/common/recording/recording_file.hpp"

namespace sealwatch::cli {
namespace {

constexpr SimulationOptions kFine = {.relative_tolerance = 1e-6, .maximum_steps = 5000000};

/// With the outputs that are not recorded, as channels without values: they are simulated too. A built-in plant
/// simulates those alone that are recorded. All start at their first sample: nothing corrects a start that is a mean, as
/// a fit does, and what moves would start too late.
TimeSeries with_all_outputs(const TimeSeries& recorded, const PlantDescription& plant) {
  TimeSeries all = recorded;
  for (Series& series : all.channels)
    if (const ChannelDescription* known = plant.find_channel(series.name); known != nullptr && !known->input)
      start_at_first_sample(series);
  for (const ChannelDescription& channel : plant.channels)
    if (!channel.input && !all.has(channel.name) && !plant.file.empty())
      all.channels.push_back({channel.name, channel.unit, 0.0, {}});
  return all;
}

double noise_of(const AssetConfig& asset, const ChannelDescription& channel) {
  const auto sensor = asset.sensors.find(channel.name);
  return sensor == asset.sensors.end() ? channel.noise_std : sensor->second.noise_std;
}

/// The inputs as they are, the outputs as simulated; `noise` of the sensors on top where it is asked for.
Recording simulated_recording(const Recording& input, const PlantSimulation& simulation, const RowMatrix& outputs,
                              const AssetConfig& asset, std::mt19937_64* noise) {
  Recording result = input;
  result.left_aside.clear(), result.warnings.clear();
  std::erase_if(result.samples.channels, [&](const Series& channel) {
    const ChannelDescription* known = simulation.plant().find_channel(channel.name);
    return known == nullptr || !known->input;
  });
  for (std::size_t c = 0; c < simulation.channels().size(); ++c) {
    const ChannelDescription& channel = *simulation.plant().find_channel(simulation.channels()[c]);
    const auto column = outputs.col(static_cast<Eigen::Index>(c));
    Series series{channel.name, channel.unit, noise == nullptr ? 0.0 : noise_of(asset, channel), {}};
    std::normal_distribution<double> error(0.0, series.noise_std > 0.0 ? series.noise_std : 1.0);
    for (const double value : column) series.values.push_back(value + (series.noise_std > 0.0 ? error(*noise) : 0.0));
    result.samples.channels.push_back(std::move(series));
  }
  return result;
}

/// `name`: of the file. `load_factor`: of a plant with a load; nothing: as the outputs in the file tell.
Status simulate_one(const Recording& input, const AssetConfig& asset, const PlantDescription& plant,
                    const SimulateOptions& options, const std::string& name, std::optional<double> load_factor,
                    std::mt19937_64* noise) {
  const auto placed = [&](Error error) {
    if (error.file.empty()) error.file = input.file;
    return fail(std::move(error));
  };
  const auto simulation = PlantSimulation::create(asset, with_all_outputs(input.samples, plant));
  if (!simulation) return placed(simulation.error());
  ModelValues values = (*simulation)->start();
  if (load_factor && plant.has_load()) values.load_factor = *load_factor;
  const auto outputs = (*simulation)->run(values, {}, kFine);
  if (!outputs) return placed(outputs.error());
  namespace fs = std::filesystem;
  std::error_code problem;
  fs::create_directories(options.directory, problem);
  const fs::path file = fs::path(options.directory) / (name + ".csv");
  if (fs::exists(file, problem))
    return fail(Error{.file = file.string(),
                      .place = {},
                      .value = {},
                      .rule = "is there already",
                      .advice = "give another directory with --out"});
  Status written =
      write_recording_csv(simulated_recording(input, **simulation, outputs->values, asset, noise), file.string());
  if (!written) return written;
  std::printf("%s: %td samples of %zu outputs in %zu steps%s\n", file.string().c_str(), outputs->values.rows(),
              (*simulation)->channels().size(), outputs->steps, noise == nullptr ? "" : ", with the sensors' noise");
  return {};
}

std::mt19937_64* used(std::mt19937_64& noise, const SimulateOptions& options) {
  return options.noise ? &noise : nullptr;
}

/// The same test month by month, while what wears has the value of each month.
int simulate_life(const Recording& input, const AssetConfig& asset, const PlantDescription& plant,
                  const SimulateOptions& options) {
  if (!asset.condition || asset.condition->parameter.empty())
    return complain(Error{.file = options.asset_file,
                          .place = "condition",
                          .value = {},
                          .rule = "is needed to simulate a life: which parameter wears, and between which values",
                          .advice = "condition: {parameter: NAME, at_100: VALUE, at_60: VALUE}"}),
           kBadInput;
  const std::optional<bench::LifeSetting> life = life_of(options);
  if (!life) return kBadInput;
  const std::vector<bench::PlannedTest> plan = plan_of(asset, *life);
  if (plan.empty()) return kBadInput;
  std::filesystem::create_directories(options.directory);
  std::ofstream truth(std::filesystem::path(options.directory) / "truth.jsonl");
  for (const bench::PlannedTest& test : plan) {
    std::string name = test.recorded_share > 0.0 ? format_date(test.start_time) + "-PST-" + asset.asset_id : "";
    truth << truth_line(*asset.condition, test, name) << "\n";
    if (name.empty()) continue;
    AssetConfig worn = asset;
    worn.parameters.at(asset.condition->parameter).value = test.resistance_Pa_s_m3;
    Recording recording = input;
    recording.asset_id = asset.asset_id;
    recording.recording_id = name;
    recording.start_time = test.start_time;
    bench::cut(recording.samples, test.recorded_share);
    std::ranges::replace(name, '/', '_');  // of an asset's id
    std::mt19937_64 noise(test.seed);
    if (const Status done = simulate_one(recording, worn, plant, options, name, test.load_factor, used(noise, options));
        !done)
      return complain(done.error()), kBadInput;
  }
  if (!truth.flush())
    return complain(Error{.file = options.directory + "/truth.jsonl",
                          .place = {},
                          .value = {},
                          .rule = "cannot be written to",
                          .advice = "make room"}),
           kBadInput;
  say_life(plan, options.directory);
  return kOk;
}

}  // namespace

int run_simulate_input(const SimulateOptions& options) {
  std::optional<AssetConfig> asset = load_asset_or_explain(options.asset_file, options.map_file);
  if (!asset) return kBadInput;
  asset->channel_map.log.repeated_times = "jump";  // simulation tools write inputs so
  const auto plant = find_plant(asset->model);
  if (!plant) return complain(plant.error()), kBadInput;
  const auto inputs = read_recordings(options.inputs, *asset, **plant);
  if (!inputs) return kBadInput;
  if (options.ageing || options.months > 1 || options.condition != SimulateOptions{}.condition) {
    if (inputs->size() == 1) return simulate_life(inputs->front(), *asset, **plant, options);
    return complain(Error{.file = {},
                          .place = "--input",
                          .value = std::to_string(inputs->size()) + " files",
                          .rule = "must be one, of the test that is repeated, where a life is simulated",
                          .advice = {}}),
           kBadInput;
  }
  tell_runaway(*inputs, *asset);
  std::mt19937_64 noise(options.seed);
  for (const Recording& input : *inputs)
    if (const Status done = simulate_one(input, *asset, **plant, options,
                                         std::filesystem::path(input.file).stem().string(), {}, used(noise, options));
        !done)
      return complain(done.error()), kBadInput;
  return kOk;
}

}  // namespace sealwatch::cli

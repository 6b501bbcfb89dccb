// `sealwatch simulate --input`: the asset's plant, driven by what a file says of its inputs.
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <random>

#include "sealwatch/model/simulation.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/recordings.hpp"
#include "services/cli/session.hpp"
#include "services/common/recording/recording_file.hpp"

namespace sealwatch::cli {
namespace {

constexpr SimulationOptions kFine = {.relative_tolerance = 1e-6, .maximum_steps = 5000000};

/// With the outputs that are not recorded, as channels without values: they are simulated too. A built-in plant starts
/// where its recorded outputs do, and simulates those alone.
TimeSeries with_all_outputs(const TimeSeries& recorded, const PlantDescription& plant) {
  TimeSeries all = recorded;
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
  result.left_aside.clear();
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

Status simulate_one(const Recording& input, const AssetConfig& asset, const PlantDescription& plant,
                    const SimulateOptions& options, std::mt19937_64* noise) {
  const auto placed = [&](Error error) {
    if (error.file.empty()) error.file = input.file;
    return fail(std::move(error));
  };
  const auto simulation = PlantSimulation::create(asset, with_all_outputs(input.samples, plant));
  if (!simulation) return placed(simulation.error());
  const auto outputs = (*simulation)->run((*simulation)->start(), {}, kFine);
  if (!outputs) return placed(outputs.error());
  namespace fs = std::filesystem;
  std::error_code problem;
  fs::create_directories(options.directory, problem);
  const fs::path file = fs::path(options.directory) / (fs::path(input.file).stem().string() + ".csv");
  if (fs::exists(file, problem))
    return fail(Error{.file = file.string(),
                      .place = {},
                      .value = {},
                      .rule = "is there already",
                      .advice = "give another directory with --out"});
  const Status written =
      write_recording_csv(simulated_recording(input, **simulation, outputs->values, asset, noise), file.string());
  if (!written) return written;
  std::printf("%s: %td samples of %zu outputs in %zu steps%s\n", file.string().c_str(), outputs->values.rows(),
              (*simulation)->channels().size(), outputs->steps, noise == nullptr ? "" : ", with the sensors' noise");
  return {};
}

}  // namespace

int run_simulate_input(const SimulateOptions& options) {
  const std::optional<AssetConfig> asset = load_asset_or_explain(options.asset_file, options.map_file);
  if (!asset) return kBadInput;
  const auto plant = find_plant(asset->model);
  if (!plant) return complain(plant.error()), kBadInput;
  const auto inputs = read_recordings(options.inputs, *asset, **plant);
  if (!inputs) return kBadInput;
  std::mt19937_64 noise(options.seed);
  for (const Recording& input : *inputs)
    if (const Status done = simulate_one(input, *asset, **plant, options, options.noise ? &noise : nullptr); !done)
      return complain(done.error()), kBadInput;
  return kOk;
}

}  // namespace sealwatch::cli

#include "services/common/mismatch/windows.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <utility>

#include "sealwatch/model/driving_channels.hpp"
#include "services/common/estimation/channel_noise.hpp"
#include "services/common/estimation/rows_of.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kShortest = 0.5;  // of a window: a shorter rest goes to the window before

// What is measured and drives the simulation has noise.
TimeSeries with_more_noise(const AssetConfig& asset, TimeSeries samples, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const std::vector<std::string> measured = simulated_part(asset, samples).inputs;
  for (Series& channel : samples.channels) {
    if (std::ranges::find(measured, channel.name) == measured.end()) continue;
    const double noise_std = noise_std_of(asset, channel, samples.time_s);
    for (double& value : channel.values) value += noise_std * normal(random);
  }
  return samples;
}

}  // namespace

double window_of(const AssetConfig& asset, const TimeSeries& recorded) {
  if (const PlantPart part = simulated_part(asset, recorded); !part.inputs.empty()) return part.window_s;
  const auto plant = find_plant(asset.model);
  return plant ? (*plant)->window_s : 0.0;
}

Data cut_into_windows(const Data& data, double window_s) {
  Data windows;
  windows.resolution = data.resolution;
  windows.are_parts = true;
  windows.known = data.known;
  windows.given = data.given;
  windows.deadline = data.deadline;
  windows.held_within_s = data.held_within_s;
  windows.relative_tolerance = data.relative_tolerance;
  for (std::size_t k = 0; k < data.samples.size(); ++k) {
    const TimeSeries& samples = data.samples[k];
    std::size_t begin = 0, count = 0;
    while (begin < samples.time_s.size()) {
      const double end_s = samples.time_s[begin] + window_s;
      auto end = static_cast<std::size_t>(std::ranges::lower_bound(samples.time_s, end_s) - samples.time_s.begin());
      if (samples.time_s.back() - end_s < kShortest * window_s) end = samples.time_s.size();
      const std::size_t first = std::exchange(begin, end);
      if (count++ % data.window_step != 0) continue;
      windows.names.push_back(data.names[k]);
      windows.samples.push_back(rows_of(samples, first, end));
      if (!data.colour.empty()) windows.colour.push_back(data.colour[k]);
      windows.groups.push_back(static_cast<int>(k));
    }
  }
  return windows;
}

void add_input_noise(Data& data, const FittedModel& model, const Data& windows, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::map<std::string, std::pair<double, double>> squares;  // per channel: sum and count
  for (std::size_t k = 0; k < windows.samples.size(); ++k) {
    const PemRecording& part = model.problem.recordings[k];
    const auto noisy = PlantSimulation::create(model.asset, with_more_noise(model.asset, windows.samples[k], random));
    if (!noisy) continue;
    const ModelValues values = values_at(model.problem, k, model.optimum.point.shared, model.optimum.point.own[k]);
    const auto outputs = (*noisy)->run(values, {}, model.problem.simulation_options);
    if (!outputs) continue;
    const RowMatrix difference = outputs->values - model.optimum.at_optimum[k].simulated;
    for (Eigen::Index c = 0; c < difference.cols(); ++c) {
      auto& [sum, count] = squares[part.simulation->channels()[static_cast<std::size_t>(c)]];
      sum += difference.col(c).squaredNorm();
      count += static_cast<double>(difference.rows());
    }
  }
  for (TimeSeries& samples : data.samples)
    for (Series& channel : samples.channels) {
      const auto found = squares.find(channel.name);
      if (found == squares.end() || !(found->second.second > 0.0)) continue;
      channel.noise_std = std::sqrt(std::pow(noise_std_of(model.asset, channel, samples.time_s), 2) +
                                    found->second.first / found->second.second);
    }
}

}  // namespace sealwatch::mismatch

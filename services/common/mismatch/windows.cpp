#include "services/common/mismatch/windows.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <random>
#include <tuple>
#include <utility>

#include "sealwatch/model/driving_channels.hpp"
#include "services/common/estimation/channel_noise.hpp"
#include "services/common/estimation/rows_of.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kShortest = 0.5;  // of a window: a shorter rest goes to the window before

// As many values of such noise as there are in `values`, added to them.
void add_noise(const ChannelColour& colour, double noise_std, std::mt19937_64& random, std::vector<double>& values) {
  constexpr std::size_t kUntilSteady = 200;
  std::normal_distribution<double> normal;
  const std::vector<double>& a = colour.coefficients;
  std::vector<double> noise(kUntilSteady + values.size());
  for (std::size_t k = 0; k < noise.size(); ++k) {
    noise[k] = colour.innovation_std * normal(random);
    for (std::size_t j = 0; j < std::min(a.size(), k); ++j) noise[k] += a[j] * noise[k - 1 - j];
  }
  for (std::size_t k = 0; k < values.size(); ++k) values[k] += noise_std * noise[kUntilSteady + k];
}

// What is measured and drives the simulation, with as much noise again.
TimeSeries with_more_noise(const AssetConfig& asset, TimeSeries samples, const NoiseColour& of_inputs,
                           std::mt19937_64& random) {
  const std::vector<std::string> inputs = simulated_part(asset, samples).inputs;
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    const auto channel = std::ranges::find(samples.channels, inputs[k], &Series::name);
    add_noise(of_inputs[k], noise_std_of(asset, *channel, samples.time_s), random, channel->values);
  }
  return samples;
}

// What the window's own start and load make of the difference is no noise: they are fitted. Nor are samples that do not
// count: they are 0 then.
void take_off_own(const PemRecording& window, const SimulatedOutputs& own, RowMatrix& difference) {
  Eigen::VectorXd scale = window.noise_std.cwiseInverse().replicate(difference.rows(), 1);  // 0: left out
  Eigen::Map<Eigen::VectorXd> all(difference.data(), difference.size());
  if (window.weight.size() > 0) {
    scale = (window.weight.array() > 0.0).select(scale, 0.0);
    all = (window.weight.array() > 0.0).select(all, 0.0);
  }
  const Eigen::VectorXd one_over = (scale.array() > 0.0).select(scale.cwiseInverse(), 0.0);
  Eigen::MatrixXd columns = scale.asDiagonal() * Eigen::MatrixXd(own.sensitivities);
  for (auto column : columns.colwise()) column /= std::max(column.norm(), 1e-300);
  const Eigen::VectorXd fitted = columns * columns.colPivHouseholderQr().solve(scale.cwiseProduct(all));
  all -= one_over.cwiseProduct(fitted);
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
  windows.of_inputs = data.of_inputs;
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

InputNoise input_noise(const FittedModel& model, const Data& windows, const NoiseColour& of_inputs,
                       std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::map<std::string, std::pair<Covariances, double>> sums;  // per channel, and how many samples
  for (std::size_t k = 0; k < windows.samples.size(); ++k) {
    const PemRecording& part = model.problem.recordings[k];
    const auto noisy =
        PlantSimulation::create(model.asset, with_more_noise(model.asset, windows.samples[k], of_inputs, random));
    if (!noisy) continue;
    std::vector<FreeQuantity> own;
    for (const Unknown& unknown : part.own) own.push_back(unknown.quantity);
    const ModelValues values = values_at(model.problem, k, model.optimum.point.shared, model.optimum.point.own[k]);
    const auto outputs = (*noisy)->run(values, own, model.problem.simulation_options);
    if (!outputs) continue;
    RowMatrix difference = outputs->values - model.optimum.at_optimum[k].simulated;
    take_off_own(part, *outputs, difference);
    for (Eigen::Index c = 0; c < difference.cols(); ++c) {
      auto& [sum, count] = sums[part.simulation->channels()[static_cast<std::size_t>(c)]];
      add_products(difference.col(c), sum);
      count += static_cast<double>(std::ranges::count_if(weights_of(part, c), [](double w) { return w > 0.0; }));
    }
  }
  InputNoise noise;
  for (auto& [channel, of] : sums)
    for (std::size_t lag = 0; lag < of.first.size(); ++lag) noise[channel][lag] = of.first[lag] / of.second;
  return noise;
}

Result<FittedModel> feigned_by_inputs(const FittedModel& model, const Data& windows, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  FittedModel feigned{.asset = model.asset,
                      .problem = {.shared = model.problem.shared,
                                  .recordings = {},
                                  .simulation_options = model.problem.simulation_options},
                      .optimum = {}};
  feigned.optimum.point = model.optimum.point;
  for (std::size_t k = 0; k < windows.samples.size(); ++k) {
    const PemRecording& part = model.problem.recordings[k];
    TimeSeries samples = with_more_noise(model.asset, windows.samples[k], windows.of_inputs, random);
    const RowMatrix& simulated = model.optimum.at_optimum[k].simulated;
    for (std::size_t c = 0; c < part.simulation->channels().size(); ++c) {
      const auto series = std::ranges::find(samples.channels, part.simulation->channels()[c], &Series::name);
      for (std::size_t row = 0; row < series->values.size(); ++row)
        series->values[row] = simulated(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(c));
    }
    auto noisy = PlantSimulation::create(model.asset, samples);
    if (!noisy) return fail(noisy.error());
    feigned.problem.recordings.push_back({.simulation = std::move(*noisy),
                                          .noise_std = part.noise_std,
                                          .time_s = part.time_s,
                                          .group = part.group,
                                          .colour = part.colour,
                                          .weight = part.weight,
                                          .own = part.own});
  }
  return feigned;
}

void add_input_noise(Data& data, const AssetConfig& asset, std::span<const std::string> channels,
                     const InputNoise& noise) {
  for (std::size_t k = 0; k < data.samples.size(); ++k)
    for (std::size_t c = 0; c < channels.size(); ++c) {
      const auto more = noise.find(channels[c]);
      const auto series = std::ranges::find(data.samples[k].channels, channels[c], &Series::name);
      if (more == noise.end() || series == data.samples[k].channels.end()) continue;
      const double sensor_std = noise_std_of(asset, *series, data.samples[k].time_s);
      std::tie(data.colour[k][c], series->noise_std) = sum_of_noise(data.colour[k][c], sensor_std, more->second);
    }
}

}  // namespace sealwatch::mismatch

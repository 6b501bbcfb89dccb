#include "services/common/estimation/interpolation_error.hpp"

#include <algorithm>
#include <cmath>

namespace sealwatch {
namespace {

constexpr double kMatters = 0.2;  // of the noise: below it the noise grows by less than 2 %

// Nothing unrecorded lies between the samples of an input that is held, or that holds nothing faster than they show.
bool all_inputs_known(const PlantDescription& plant, const TimeSeries& recorded) {
  return recorded.input_hold ||
         std::all_of(plant.channels.begin(), plant.channels.end(), [&recorded](const ChannelDescription& channel) {
           return !channel.input || channel.hold || channel.band_limited || !recorded.has(channel.name);
         });
}

TimeSeries every_second_sample(const TimeSeries& samples) {
  const auto thin = [](const std::vector<double>& values) {
    std::vector<double> half;
    for (std::size_t k = 0; k < values.size(); k += 2) half.push_back(values[k]);
    return half;
  };
  TimeSeries result{.time_s = thin(samples.time_s), .channels = {}, .input_hold = samples.input_hold};
  for (const Series& channel : samples.channels)
    result.channels.push_back(
        {.name = channel.name, .unit = channel.unit, .noise_std = channel.noise_std, .values = thin(channel.values)});
  return result;
}

// Every second sample from `begin` to `end` is what is linear between its neighbours. Whether that changes anything.
bool pass_over_every_second(TimeSeries& samples, const PlantDescription& plant, std::size_t begin, std::size_t end) {
  bool changed = false;
  for (Series& channel : samples.channels) {
    const ChannelDescription* description = plant.find_channel(channel.name);
    if (description == nullptr || !description->input || description->hold || description->band_limited) continue;
    for (std::size_t k = begin + 1 - begin % 2; k < end && k + 1 < samples.time_s.size(); k += 2) {
      const double share =
          (samples.time_s[k] - samples.time_s[k - 1]) / (samples.time_s[k + 1] - samples.time_s[k - 1]);
      const double between = channel.values[k - 1] + share * (channel.values[k + 1] - channel.values[k - 1]);
      changed = changed || between != channel.values[k];
      channel.values[k] = between;
    }
  }
  return changed;
}

}  // namespace

std::vector<RowMatrix> changes_by_pieces(const PemProblem& problem, std::size_t recording, const PemOptimum& optimum,
                                         const AssetConfig& asset, const TimeSeries& recorded) {
  constexpr std::size_t kPieces = 16;  // their sum is then known within a third
  const PemRecording& part = problem.recordings[recording];
  std::vector<RowMatrix> changes;
  if (all_inputs_known(part.simulation->plant(), recorded)) return changes;
  const ModelValues values = values_at(problem, recording, optimum.point.shared, optimum.point.own[recording]);
  std::size_t asked = 0;
  for (std::size_t piece = 0; piece < kPieces; ++piece) {
    TimeSeries passed_over = recorded;
    const std::size_t samples = recorded.time_s.size();
    if (!pass_over_every_second(passed_over, part.simulation->plant(), piece * samples / kPieces,
                                (piece + 1) * samples / kPieces))
      continue;
    ++asked;
    const auto simulation = PlantSimulation::create(asset, passed_over);
    if (!simulation) continue;
    auto outputs = (*simulation)->run(values, {}, problem.simulation_options);
    if (outputs) changes.push_back(outputs->values - optimum.at_optimum[recording].simulated);
  }
  // Those that cannot be simulated are taken to move as much as the others.
  const double missing = changes.empty() ? 1.0 : static_cast<double>(asked) / static_cast<double>(changes.size());
  for (RowMatrix& change : changes) change *= std::sqrt(missing);
  return changes;
}

RowMatrix change_without_every_second_sample(const PemProblem& problem, std::size_t recording,
                                             const PemOptimum& optimum, const AssetConfig& asset,
                                             const TimeSeries& recorded) {
  const PemRecording& part = problem.recordings[recording];
  RowMatrix none(0, part.noise_std.size());
  if (all_inputs_known(part.simulation->plant(), recorded)) return none;
  const auto thinned = PlantSimulation::create(asset, every_second_sample(recorded));
  if (!thinned) return none;
  const ModelValues values = values_at(problem, recording, optimum.point.shared, optimum.point.own[recording]);
  auto outputs = (*thinned)->run(values, {}, problem.simulation_options);
  if (!outputs) return none;
  const RowMatrix& simulated = optimum.at_optimum[recording].simulated;
  for (Eigen::Index k = 0; k < outputs->values.rows(); ++k) outputs->values.row(k) -= simulated.row(2 * k);
  return std::move(outputs->values);
}

bool add_interpolation_error(PemProblem& problem, const PemOptimum& optimum, const AssetConfig& asset,
                             std::span<const TimeSeries> recordings) {
  bool matters = false;
  for (std::size_t k = 0; k < recordings.size(); ++k) {
    Eigen::VectorXd& noise_std = problem.recordings[k].noise_std;
    const RowMatrix change = change_without_every_second_sample(problem, k, optimum, asset, recordings[k]);
    if (change.rows() == 0) continue;
    const Eigen::VectorXd error =
        (change.colwise().squaredNorm() / static_cast<double>(change.rows())).cwiseSqrt() / 3.0;
    for (Eigen::Index c = 0; c < noise_std.size(); ++c) {
      if (error(c) <= kMatters * noise_std(c)) continue;
      noise_std(c) = std::hypot(noise_std(c), error(c));
      matters = true;
    }
  }
  return matters;
}

}  // namespace sealwatch

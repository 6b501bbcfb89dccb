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

}  // namespace

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

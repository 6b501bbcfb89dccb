#include "services/common/estimation/interpolation_error.hpp"

#include <algorithm>
#include <cmath>

namespace sealwatch {
namespace {

constexpr double kMatters = 0.2;  // of the noise: below it the noise grows by less than 2 %

// Nothing lies between the samples of an input that is held.
bool all_inputs_held(const PlantDescription& plant, const TimeSeries& recorded) {
  return recorded.input_hold ||
         std::all_of(plant.channels.begin(), plant.channels.end(), [&recorded](const ChannelDescription& channel) {
           return !channel.input || channel.hold || !recorded.has(channel.name);
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

// Per channel; zero where it cannot be told.
Eigen::VectorXd interpolation_error(const PemProblem& problem, std::size_t recording, const PemOptimum& optimum,
                                    const AssetConfig& asset, const TimeSeries& recorded) {
  Eigen::VectorXd error = Eigen::VectorXd::Zero(problem.recordings[recording].noise_std.size());
  if (all_inputs_held(problem.recordings[recording].simulation->plant(), recorded)) return error;
  const auto thinned = PlantSimulation::create(asset, every_second_sample(recorded));
  if (!thinned) return error;
  const ModelValues values = values_at(problem, recording, optimum.point.shared, optimum.point.own[recording]);
  const auto outputs = (*thinned)->run(values, {}, problem.simulation_options);
  if (!outputs) return error;
  const RowMatrix& simulated = optimum.at_optimum[recording].simulated;
  for (Eigen::Index k = 0; k < outputs->values.rows(); ++k)
    error += (outputs->values.row(k) - simulated.row(2 * k)).cwiseAbs2().transpose();
  return (error / static_cast<double>(outputs->values.rows())).cwiseSqrt() / 3.0;
}

}  // namespace

bool add_interpolation_error(PemProblem& problem, const PemOptimum& optimum, const AssetConfig& asset,
                             std::span<const TimeSeries> recordings) {
  bool matters = false;
  for (std::size_t k = 0; k < recordings.size(); ++k) {
    Eigen::VectorXd& noise_std = problem.recordings[k].noise_std;
    const Eigen::VectorXd error = interpolation_error(problem, k, optimum, asset, recordings[k]);
    for (Eigen::Index c = 0; c < noise_std.size(); ++c) {
      if (error(c) <= kMatters * noise_std(c)) continue;
      noise_std(c) = std::hypot(noise_std(c), error(c));
      matters = true;
    }
  }
  return matters;
}

}  // namespace sealwatch

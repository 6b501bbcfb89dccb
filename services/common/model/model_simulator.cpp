#include "services/common/model/model_simulator.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace sealwatch {
namespace {

constexpr int kIterations = 8;
constexpr int kHalvings = 4;
constexpr double kSettled = 1e-3;  // relative decrease of the cost that is not worth another iteration

double noise_std(const PlantSimulation& simulation, const AssetConfig& asset, const std::string& channel) {
  const auto sensor = asset.sensors.find(channel);
  if (sensor != asset.sensors.end() && sensor->second.noise_std > 0.0) return sensor->second.noise_std;
  const double nominal = simulation.plant().find_channel(channel)->noise_std;
  return nominal > 0.0 ? nominal : 1.0;
}

/// The fit's normal equations at one point. Each channel is weighted by its noise and its mean square misfit together,
/// so that a channel which the model cannot follow does not bend all others: cost = sum_c n ln(noise_c^2 + mean r_c^2).
struct LinearisedFit {
  double cost = 0.0;
  Eigen::MatrixXd hessian;
  Eigen::VectorXd gradient;
};

LinearisedFit linearise(const PlantSimulation& simulation, const AssetConfig& asset, const SimulatedOutputs& outputs) {
  const Eigen::Index channels = outputs.values.cols(), free = outputs.sensitivities.cols();
  LinearisedFit fit{0.0, Eigen::MatrixXd::Zero(free, free), Eigen::VectorXd::Zero(free)};
  for (Eigen::Index c = 0; c < channels; ++c) {
    const double noise = noise_std(simulation, asset, simulation.channels()[static_cast<std::size_t>(c)]);
    const Eigen::VectorXd residual = simulation.recorded().col(c) - outputs.values.col(c);
    const auto samples = static_cast<double>(residual.size());
    const double variance = noise * noise + residual.squaredNorm() / samples;
    const Eigen::Map<const RowMatrix, 0, Eigen::OuterStride<>> slopes(
        outputs.sensitivities.data() + c * free, residual.size(), free, Eigen::OuterStride<>(channels * free));
    fit.cost += samples * std::log(variance / (noise * noise));
    fit.hessian += slopes.transpose() * slopes / variance;
    fit.gradient += slopes.transpose() * residual / variance;
  }
  return fit;
}

/// Solves the normal equations scaled to a unit diagonal; the small ridge keeps what the channels do not show where it
/// is.
Eigen::VectorXd newton_step(const LinearisedFit& fit) {
  constexpr double kRidge = 1e-10;
  const Eigen::VectorXd scale = fit.hessian.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd scaled = scale.asDiagonal() * fit.hessian * scale.asDiagonal();
  scaled.diagonal().array() += kRidge;
  return scale.asDiagonal() * scaled.ldlt().solve(scale.asDiagonal() * fit.gradient);
}

ModelValues moved(ModelValues values, std::span<const FreeQuantity> free, const Eigen::VectorXd& step) {
  for (std::size_t k = 0; k < free.size(); ++k) free[k].in(values) += step[static_cast<Eigen::Index>(k)];
  return values;
}

std::vector<FreeQuantity> operating_point(const PlantSimulation& simulation) {
  std::vector<FreeQuantity> free = {simulation.find("load_factor").value()};
  for (const std::string& state : simulation.slow_state_names())
    free.push_back(simulation.find("initial:" + state).value());
  return free;
}

}  // namespace

Result<ModelValues> fit_operating_point(const PlantSimulation& simulation, const AssetConfig& asset,
                                        const SimulationOptions& options) {
  const std::vector<FreeQuantity> free = operating_point(simulation);
  ModelValues values = simulation.start();
  const auto first = simulation.run(values, free, options);
  if (!first) return fail(first.error());
  LinearisedFit fit = linearise(simulation, asset, *first);
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    Eigen::VectorXd step = newton_step(fit);
    const double cost = fit.cost;
    for (int halving = 0; halving <= kHalvings; ++halving, step *= 0.5) {
      const ModelValues candidate = moved(values, free, step);
      const auto outputs = simulation.run(candidate, free, options);
      if (!outputs) continue;
      LinearisedFit next = linearise(simulation, asset, *outputs);
      if (!(next.cost < fit.cost)) continue;
      values = candidate;
      fit = std::move(next);
      break;
    }
    if (fit.cost > (1.0 - kSettled) * cost) break;
  }
  return values;
}

Result<TimeSeries> ModelSimulator::simulate(const AssetConfig& asset, const TimeSeries& recorded) const {
  const auto simulation = PlantSimulation::create(asset, recorded);
  if (!simulation) return fail(simulation.error());
  const auto values = fit_operating_point(**simulation, asset);
  if (!values) return fail(values.error());
  const auto outputs = (*simulation)->run(*values, {});
  if (!outputs) return fail(outputs.error());
  TimeSeries predicted{recorded.time_s, {}, recorded.input_hold};
  for (std::size_t c = 0; c < (*simulation)->channels().size(); ++c) {
    const Series& measured = *recorded.find((*simulation)->channels()[c]);
    const auto column = outputs->values.col(static_cast<Eigen::Index>(c));
    predicted.channels.push_back({measured.name, measured.unit, measured.noise_std, {column.begin(), column.end()}});
  }
  return predicted;
}

}  // namespace sealwatch

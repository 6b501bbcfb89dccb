#include "services/common/model/model_simulator.hpp"

#include <algorithm>
#include <cmath>

#include "services/common/dense/dense.hpp"

namespace sealwatch {
namespace {

constexpr int kStages = 2;  // weights from the start's misfit, then from the first stage's
constexpr int kIterations = 6;
constexpr int kHalvings = 4;
constexpr double kSettled = 1e-3;  // relative decrease of the cost that is not worth another iteration

double noise_std(const PlantSimulation& simulation, const AssetConfig& asset, const std::string& channel) {
  const auto sensor = asset.sensors.find(channel);
  if (sensor != asset.sensors.end() && sensor->second.noise_std > 0.0) return sensor->second.noise_std;
  const double nominal = simulation.plant().find_channel(channel)->noise_std;
  return nominal > 0.0 ? nominal : 1.0;
}

/// Variance with which each channel is weighted: its noise and its mean square misfit at the last stage together, so
/// that a channel which the model cannot follow does not bend all others.
Eigen::VectorXd variances(const PlantSimulation& simulation, const AssetConfig& asset,
                          const SimulatedOutputs& outputs) {
  Eigen::VectorXd variance(outputs.values.cols());
  for (Eigen::Index c = 0; c < variance.size(); ++c) {
    const double noise = noise_std(simulation, asset, simulation.channels()[static_cast<std::size_t>(c)]);
    variance[c] = noise * noise + (simulation.recorded().col(c) - outputs.values.col(c)).squaredNorm() /
                                      static_cast<double>(outputs.values.rows());
  }
  return variance;
}

/// The fit's normal equations at one point.
struct LinearisedFit {
  double cost = 0.0;
  Eigen::MatrixXd hessian;
  Eigen::VectorXd gradient;
};

LinearisedFit linearise(const PlantSimulation& simulation, const Eigen::VectorXd& variance,
                        const SimulatedOutputs& outputs) {
  const Eigen::Index channels = outputs.values.cols(), free = outputs.sensitivities.cols();
  LinearisedFit fit{0.0, Eigen::MatrixXd::Zero(free, free), Eigen::VectorXd::Zero(free)};
  for (Eigen::Index c = 0; c < channels; ++c) {
    const Eigen::VectorXd residual = simulation.recorded().col(c) - outputs.values.col(c);
    const Eigen::Map<const RowMatrix, 0, Eigen::OuterStride<>> slopes(
        outputs.sensitivities.data() + c * free, residual.size(), free, Eigen::OuterStride<>(channels * free));
    fit.cost += residual.squaredNorm() / variance[c];
    fit.hessian += slopes.transpose() * slopes / variance[c];
    fit.gradient += slopes.transpose() * residual / variance[c];
  }
  return fit;
}

/// Solves the normal equations scaled to a unit diagonal; the small ridge keeps what the channels do not show where it
/// is.
Eigen::VectorXd newton_step(const LinearisedFit& fit) {
  constexpr double kRidge = 1e-10;
  const Eigen::VectorXd scale = fit.hessian.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd scaled = dense::scaled(fit.hessian, scale);
  scaled.diagonal().array() += kRidge;
  return scale.asDiagonal() * dense::Symmetric(scaled).solve(Eigen::VectorXd(scale.asDiagonal() * fit.gradient));
}

ModelValues moved(const PlantSimulation& simulation, ModelValues values, std::span<const FreeQuantity> free,
                  const Eigen::VectorXd& step) {
  for (std::size_t k = 0; k < free.size(); ++k) free[k].in(values) += step[static_cast<Eigen::Index>(k)];
  for (const std::string& state : simulation.slow_state_names()) {
    const auto [least, most] = simulation.initial_range(state);
    double& initial = simulation.find("initial:" + state)->in(values);
    initial = std::clamp(initial, least, most);
  }
  return values;
}

std::vector<FreeQuantity> operating_point(const PlantSimulation& simulation) {
  std::vector<FreeQuantity> free;
  if (simulation.plant().has_load()) free.push_back(simulation.find("load_factor").value());
  for (const std::string& state : simulation.slow_state_names())
    free.push_back(simulation.find("initial:" + state).value());
  return free;
}

/// One stage of Gauss-Newton's method with fixed weights: improves values and their outputs.
void improve(const PlantSimulation& simulation, const Eigen::VectorXd& variance, std::span<const FreeQuantity> free,
             const SimulationOptions& options, ModelValues& values, SimulatedOutputs& outputs) {
  LinearisedFit fit = linearise(simulation, variance, outputs);
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    Eigen::VectorXd step = newton_step(fit);
    const double cost = fit.cost;
    for (int halving = 0; halving <= kHalvings; ++halving, step *= 0.5) {
      const ModelValues candidate = moved(simulation, values, free, step);
      auto next = simulation.run(candidate, free, options);
      if (!next) continue;
      LinearisedFit next_fit = linearise(simulation, variance, *next);
      if (!(next_fit.cost < cost)) continue;
      values = candidate;
      outputs = std::move(*next);
      fit = std::move(next_fit);
      break;
    }
    if (fit.cost > (1.0 - kSettled) * cost) break;
  }
}

}  // namespace

Result<ModelValues> fit_operating_point(const PlantSimulation& simulation, const AssetConfig& asset,
                                        const SimulationOptions& options) {
  const std::vector<FreeQuantity> free = operating_point(simulation);
  ModelValues values = simulation.start();
  auto outputs = simulation.run(values, free, options);
  if (!outputs) return fail(outputs.error());
  for (int stage = 0; stage < kStages; ++stage)
    improve(simulation, variances(simulation, asset, *outputs), free, options, values, *outputs);
  return values;
}

Result<TimeSeries> ModelSimulator::simulate(const AssetConfig& asset, const TimeSeries& recorded,
                                            const std::stop_token& cancel) const {
  const Deadline deadline(cancel);
  const SimulationOptions options{.deadline = &deadline};
  const auto simulation = PlantSimulation::create(asset, recorded);
  if (!simulation) return fail(simulation.error());
  const auto values = fit_operating_point(**simulation, asset, options);
  if (!values) return fail(values.error());
  const auto outputs = (*simulation)->run(*values, {}, options);
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

#include "services/common/mismatch/tolerance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sealwatch/model/physics.hpp"
#include "services/common/dense/dense.hpp"
#include "services/common/mismatch/candidates.hpp"
#include "services/common/mismatch/linear_algebra.hpp"
#include "services/common/mismatch/normal_equations.hpp"

namespace sealwatch::mismatch {

namespace {

// Of what a sensor reads, in all recordings.
double range_of(const PemProblem& problem, std::size_t sensor) {
  double least = std::numeric_limits<double>::infinity(), largest = -least;
  for (const PemRecording& recording : problem.recordings) {
    const PlantSimulation& simulation = *recording.simulation;
    const auto reach = [&](double from, double to) { least = std::min(least, from), largest = std::max(largest, to); };
    if (sensor < simulation.channels().size()) {
      const auto values = simulation.recorded().col(static_cast<Eigen::Index>(sensor));
      reach(values.minCoeff(), values.maxCoeff());
      continue;
    }
    const auto input = std::ranges::find(simulation.inputs(), simulation.sensors()[sensor]);
    const auto [from, to] = simulation.input_range(static_cast<std::size_t>(input - simulation.inputs().begin()));
    reach(from, to);
  }
  return largest - least;
}

// What the sensors from `first` on are off by.
std::vector<KnownValue> known_from(std::size_t first, std::size_t end, const AssetConfig& asset,
                                   const PemProblem& problem) {
  std::vector<KnownValue> known;
  const std::span<const std::string> sensors = problem.recordings.front().simulation->sensors();
  for (std::size_t k = first; k < end; ++k) {
    const auto sensor = asset.sensors.find(sensors[k]);
    const SensorSetting setting = sensor == asset.sensors.end() ? SensorSetting{} : sensor->second;
    const double gain = setting.gain_tolerance > 0.0 ? setting.gain_tolerance : kUsualSensorTolerance;
    const double offset =
        setting.offset_tolerance > 0.0 ? setting.offset_tolerance : kUsualSensorTolerance * range_of(problem, k);
    known.push_back({.name = sensor_gain_name(sensors[k]), .value = 0.0, .standard_deviation = gain});
    if (offset > 0.0)
      known.push_back({.name = sensor_offset_name(sensors[k]), .value = 0.0, .standard_deviation = offset});
  }
  return known;
}

}  // namespace

std::vector<KnownValue> known_values(const AssetConfig& asset, const PlantDescription& plant) {
  std::vector<KnownValue> known;
  for (const auto& [name, setting] : asset.parameters) {
    const ParameterDescription* parameter = plant.find_parameter(name);
    if (parameter == nullptr || setting.estimate || setting.value == 0.0 || name == plant.load_parameter) continue;
    const double tolerance =
        setting.tolerance > 0.0 ? setting.tolerance : parameter->tolerance * std::abs(setting.value);
    if (tolerance > 0.0) known.push_back({.name = name, .value = setting.value, .standard_deviation = tolerance});
  }
  return known;
}

std::vector<KnownValue> known_sensors(const AssetConfig& asset, const PemProblem& problem) {
  return known_from(0, problem.recordings.front().simulation->channels().size(), asset, problem);
}

std::vector<KnownValue> known_inputs(const AssetConfig& asset, const PemProblem& problem) {
  const PlantSimulation& simulation = *problem.recordings.front().simulation;
  return known_from(simulation.channels().size(), simulation.sensors().size(), asset, problem);
}

double occam_factor(const FittedModel& model, const std::vector<KnownValue>& of, double phi) {
  Eigen::MatrixXd gram = normal_equations(model).gram / phi;
  std::vector<Eigen::Index> asked, others;
  for (Eigen::Index k = 0; k < gram.cols(); ++k) {
    const auto at = static_cast<std::size_t>(k);
    const Unknown* unknown = at < model.problem.shared.size() ? &model.problem.shared[at] : nullptr;
    const bool is_asked = unknown != nullptr && std::ranges::find(of, unknown->name, &KnownValue::name) != of.end();
    (is_asked ? asked : others).push_back(k);
    if (unknown == nullptr || !unknown->is_known()) continue;
    if (!is_asked) gram(k, k) += 1.0 / (unknown->prior_std * unknown->prior_std);
    if (!is_asked) continue;
    gram.row(k) *= unknown->prior_std;
    gram.col(k) *= unknown->prior_std;
  }
  const Eigen::VectorXd scale = gram.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd given_way = submatrix(dense::scaled(gram, scale), others);
  given_way.diagonal().array() += kRidge;
  const Eigen::MatrixXd across = scale(others).asDiagonal() * gram(others, asked);
  Eigen::MatrixXd left =
      submatrix(gram, asked) - dense::transposed_product(across, dense::Symmetric(given_way).solve_columns(across));
  left.diagonal().array() += 1.0;
  return dense::Symmetric(left).pivots().cwiseMax(1.0).array().log().sum();
}

std::string tolerated_name(const Effect& effect) {
  constexpr std::string_view kSensor = "sensor:";
  if (!effect.element.starts_with(kSensor)) return {};
  const std::string channel = effect.element.substr(kSensor.size());
  if (effect.law->kind == SiteKind::sensor_gain) return sensor_gain_name(channel);
  return effect.law->kind == SiteKind::sensor_bias ? sensor_offset_name(channel) : "";
}

bool is_within_tolerance(const Effect& effect, const FittedModel& model, const std::vector<KnownValue>& sensors) {
  const std::string name = tolerated_name(effect);
  const auto known = std::ranges::find(sensors, name, &KnownValue::name);
  if (name.empty() || known == sensors.end()) return false;
  const std::string strength = physics_parameter_name(effect.element, effect.law->id,
                                                      effect.law->parameters[strengths_of(*effect.law).front()].name);
  return std::abs(*estimate_of(model, strength)) <= kWithinTolerance * known->standard_deviation;
}

AssetConfig with_free_value(AssetConfig asset, const std::string& name) {
  ParameterSetting& setting = asset.parameters.at(name);
  const auto [low, high] = std::minmax({setting.value / kOffByAtMost, setting.value * kOffByAtMost});
  setting = {
      .value = setting.value, .min = std::max(setting.min, low), .max = std::min(setting.max, high), .estimate = true};
  return asset;
}

bool are_beyond_tolerance(const FittedModel& model, const std::vector<KnownValue>& values) {
  for (std::size_t k = 0; k < model.problem.shared.size(); ++k) {
    const Unknown& unknown = model.problem.shared[k];
    const auto value = std::ranges::find(values, unknown.name, &KnownValue::name);
    if (value == values.end()) continue;
    const double off = unknown.to_value(model.optimum.point.shared[k]) - value->value;
    const bool within = std::abs(off) < kWithinTolerance * value->standard_deviation;
    if (within || at_bound(unknown, model.optimum.point.shared[k])) return false;
  }
  return true;
}

std::vector<KnownValue> that_show(const std::vector<KnownValue>& known, const FittedModel& model, const Data& data,
                                  int threads) {
  constexpr double kShows = 0.25;
  Data with_all = data;
  with_all.known = known;
  const Result<FittedModel> all = fit_model(model.asset, with_all, &model, threads, 0);
  if (!all) return {};
  const NormalEquations equations = normal_equations(*all);
  const Eigen::VectorXd scale = equations.gram.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd gram = dense::scaled(equations.gram, scale);
  std::vector<Eigen::Index> estimated;
  for (Eigen::Index k = 0; k < gram.cols(); ++k) {
    const auto at = static_cast<std::size_t>(k);
    if (at >= all->problem.shared.size() || !all->problem.shared[at].is_known()) estimated.push_back(k);
  }
  Eigen::MatrixXd given_way = submatrix(gram, estimated);
  given_way.diagonal().array() += kRidge;
  const dense::Symmetric factor(given_way);
  std::vector<KnownValue> shown;
  for (std::size_t k = 0; k < all->problem.shared.size(); ++k) {
    const Unknown& unknown = all->problem.shared[k];
    if (!unknown.is_known()) continue;
    const auto column = static_cast<Eigen::Index>(k);
    const Eigen::VectorXd across = gram(estimated, column);
    const double left = (gram(column, column) - across.dot(factor.solve(across))) / (scale(column) * scale(column));
    if (unknown.prior_std * unknown.prior_std * left > kShows)
      shown.push_back(*std::ranges::find(known, unknown.name, &KnownValue::name));
  }
  return shown;
}

}  // namespace sealwatch::mismatch

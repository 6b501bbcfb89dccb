#include "services/common/estimation/pem_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sealwatch/core/wide_vectors.hpp"
#include "sealwatch/model/law_sizes.hpp"
#include "services/common/dense/dense.hpp"
#include "services/common/dense/row_products.hpp"
#include "services/common/estimation/channel_noise.hpp"
#include "services/common/estimation/own_jumps.hpp"
#include "services/common/estimation/unseen_samples.hpp"

namespace sealwatch {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Status check_values(const TimeSeries& samples) {
  for (const Series& channel : samples.channels) {
    if (channel.values.size() != samples.time_s.size()) return fail(channel.name + " has not one value for each time");
    if (!std::all_of(channel.values.begin(), channel.values.end(), [](double value) { return std::isfinite(value); }))
      return fail(channel.name + " has values that are not numbers");
  }
  return {};
}

Unknown shared_unknown(const ParameterDescription& parameter, const ParameterSetting& setting, FreeQuantity quantity) {
  const bool logarithmic = parameter.positive && setting.min > 0.0 && setting.value > 0.0;
  const double span = setting.max - setting.min;
  return {.name = parameter.name,
          .unit = parameter.unit,
          .quantity = quantity,
          .logarithmic = logarithmic,
          .scale = logarithmic ? setting.value : (span > 0.0 ? span : 1.0),
          .start = setting.value,
          .min = setting.min,
          .max = setting.max};
}

// A strength may pass through 0; a shape is a scale where it is positive. The size of a user's own law, and one so wrong
// that the law sets out beyond what it allows or at next to nothing of it, are no measure of it: such a strength is of
// its own order of magnitude.
Unknown law_unknown(const PlantDescription& plant, const PhysicsParameter& parameter, FreeQuantity quantity) {
  const ParameterSetting& setting = parameter.setting;
  const bool logarithmic = !parameter.parameter->strength && setting.min > 0.0;
  const double size = law_size(plant, *parameter.parameter);
  double usual = std::abs(size * parameter.parameter->start.front());
  if (parameter.parameter->own_size || std::abs(setting.value) > size * parameter.parameter->max)
    usual = std::max(usual, std::abs(setting.value));
  constexpr double kNextToNothing = 1e-4, kNothing = 1e-8;
  if (parameter.parameter->strength && setting.value != 0.0 && std::abs(setting.value) < kNextToNothing * usual)
    usual = std::max(std::abs(setting.value), kNothing * usual);
  return {.name = parameter.name,
          .unit = std::string(parameter.parameter->unit),
          .quantity = quantity,
          .logarithmic = logarithmic,
          .scale = logarithmic ? setting.value : (usual > 0.0 ? usual : 1.0),
          .start = setting.value,
          .min = setting.min,
          .max = setting.max};
}

Unknown known_unknown(const ParameterDescription& parameter, ParameterSetting setting, const KnownValue& known,
                      FreeQuantity quantity) {
  setting.min = known.value - kWithinTolerance * known.standard_deviation;
  setting.max = known.value + kWithinTolerance * known.standard_deviation;
  setting.value = std::clamp(setting.value, setting.min, setting.max);
  Unknown unknown = shared_unknown(parameter, setting, quantity);
  unknown.prior_mean = unknown.to_unknown(known.value);
  unknown.prior_std = known.standard_deviation / unknown.slope(unknown.prior_mean);
  return unknown;
}

Unknown sensor_unknown(const KnownValue& known, FreeQuantity quantity, const PlantSimulation& simulation) {
  const double most = kWithinTolerance * known.standard_deviation;
  const bool gain = quantity.kind == FreeQuantity::Kind::sensor_gain;
  return {.name = known.name,
          .unit = gain ? "1" : simulation.plant().find_channel(simulation.sensors()[quantity.index])->unit,
          .quantity = quantity,
          .scale = known.standard_deviation,
          .start = std::clamp(quantity.in(simulation.start()), known.value - most, known.value + most),
          .min = known.value - most,
          .max = known.value + most,
          .prior_mean = known.value / known.standard_deviation,
          .prior_std = 1.0};
}

Result<std::vector<Unknown>> shared_unknowns(const AssetConfig& asset, const PlantSimulation& simulation,
                                             std::string_view own_parameter, std::span<const KnownValue> known) {
  std::vector<Unknown> unknowns;
  for (const ParameterDescription& parameter : simulation.plant().parameters) {
    const auto setting = asset.parameters.find(parameter.name);
    if (setting == asset.parameters.end() || parameter.name == simulation.plant().load_parameter ||
        parameter.name == own_parameter)
      continue;
    const auto prior = std::ranges::find(known, parameter.name, &KnownValue::name);
    if (!setting->second.estimate && prior == known.end()) continue;
    const Result<FreeQuantity> quantity = simulation.find(parameter.name);
    if (!quantity) return fail(quantity.error());
    unknowns.push_back(setting->second.estimate ? shared_unknown(parameter, setting->second, *quantity)
                                                : known_unknown(parameter, setting->second, *prior, *quantity));
  }
  for (const PhysicsParameter& parameter : simulation.physics_parameters()) {
    if (!parameter.setting.estimate) continue;
    const Result<FreeQuantity> quantity = simulation.find(parameter.name);
    if (!quantity) return fail(quantity.error());
    unknowns.push_back(law_unknown(simulation.plant(), parameter, *quantity));
  }
  for (const KnownValue& value : known)
    if (const auto quantity = simulation.find(value.name); quantity && quantity->is_of_sensor())
      unknowns.push_back(sensor_unknown(value, *quantity, simulation));
  return unknowns;
}

// One unknown of the parameter for each recording.
Status add_own_parameter(const AssetConfig& asset, std::string_view name, PemProblem& problem) {
  for (std::size_t k = 0; k < problem.recordings.size(); ++k) {
    const PlantSimulation& simulation = *problem.recordings[k].simulation;
    const ParameterDescription* parameter = simulation.plant().find_parameter(name);
    const auto setting = asset.parameters.find(std::string(name));
    if (parameter == nullptr || setting == asset.parameters.end())
      return fail("the asset has no parameter " + std::string(name));
    const Result<FreeQuantity> quantity = simulation.find(std::string(name));
    if (!quantity) return fail(quantity.error());
    Unknown unknown = shared_unknown(*parameter, setting->second, *quantity);
    unknown.name = name_in_recording(name, k);
    unknown.group = problem.recordings[k].group = static_cast<int>(k);
    problem.shared.push_back(std::move(unknown));
  }
  return {};
}

Unknown own_unknown(std::string name, std::string unit, FreeQuantity quantity, double start) {
  return {.name = std::move(name),
          .unit = std::move(unit),
          .quantity = quantity,
          .logarithmic = false,
          .scale = start != 0.0 ? std::abs(start) : 1.0,
          .start = start,
          .min = -kInfinity,
          .max = kInfinity};
}

// A load factor needs a mean load to be a factor of.
Result<Unknown> load_unknown(const PlantSimulation& simulation) {
  const std::string& name = simulation.plant().load_parameter;
  const Result<FreeQuantity> mean_load = simulation.find(name);
  if (!mean_load) return fail(mean_load.error());
  if (mean_load->in(simulation.start()) != 0.0) {
    Unknown load = own_unknown("load_factor", "1", *simulation.find("load_factor"), simulation.start().load_factor);
    load.scale = 1.0;
    return load;
  }
  const ParameterDescription& description = *simulation.plant().find_parameter(name);
  Unknown load = own_unknown(name, description.unit, *mean_load, 0.0);
  load.scale = 0.01 * (description.max - description.min);
  return load;
}

Result<std::vector<Unknown>> own_unknowns(const PlantSimulation& simulation, bool with_load) {
  std::vector<Unknown> unknowns;
  if (with_load && simulation.plant().has_load()) {
    Result<Unknown> load = load_unknown(simulation);
    if (!load) return fail(load.error());
    unknowns.push_back(std::move(*load));
  }
  for (const std::string& state : simulation.slow_state_names()) {
    const Result<FreeQuantity> quantity = simulation.find("initial:" + state);
    if (!quantity) return fail(quantity.error());
    const StateDescription* description = simulation.plant().find_state(state);
    const std::string unit = description == nullptr ? "1" : description->unit;  // of a law: an angle in rad
    unknowns.push_back(own_unknown("initial:" + state, unit, *quantity, quantity->in(simulation.start())));
    std::tie(unknowns.back().min, unknowns.back().max) = simulation.initial_range(state);
  }
  return unknowns;
}

// Whether a jump comes before or after a sample is decided by less than anyone knows of the plant, and its height is many
// times the noise: the samples on both of its sides have no weight.
void pass_over_jumps(const TimeSeries& recorded, PemRecording& recording) {
  const std::span<const std::string> channels = recording.simulation->channels();
  const Eigen::Index width = std::ssize(channels);
  for (Eigen::Index c = 0; c < width; ++c)
    for (const std::size_t behind :
         own_jumps(*recording.simulation, *recorded.find(channels[static_cast<std::size_t>(c)]))) {
      if (recording.weight.size() == 0) recording.weight = Eigen::VectorXd::Ones(width * std::ssize(recorded.time_s));
      const auto row = static_cast<Eigen::Index>(behind);
      recording.weight(width * row + c) = recording.weight(width * (row - 1) + c) = 0.0;
    }
}

Result<PemRecording> make_recording(const AssetConfig& asset, const TimeSeries& recorded, bool window) {
  if (const Status usable = check_values(recorded); !usable) return fail(usable.error());
  Result<std::unique_ptr<PlantSimulation>> simulation = PlantSimulation::create(asset, recorded);
  if (!simulation) return fail(simulation.error());
  PemRecording recording{.simulation = std::move(*simulation), .noise_std = {}, .time_s = recorded.time_s, .own = {}};
  const std::span<const std::string> channels = recording.simulation->channels();
  recording.noise_std.resize(static_cast<Eigen::Index>(channels.size()));
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const double estimated = noise_std_of(asset, *recorded.find(channels[c]), recorded.time_s);
    const double noise_std = estimated > 0.0 ? estimated : kInfinity;
    recording.noise_std(static_cast<Eigen::Index>(c)) = noise_std;
  }
  Result<std::vector<Unknown>> own = own_unknowns(*recording.simulation, !window);
  if (!own) return fail(own.error());
  recording.own = std::move(*own);
  pass_over_jumps(recorded, recording);
  leave_out(unseen_samples(asset, recorded), recording);
  return recording;
}

}  // namespace

void leave_out(const std::vector<Eigen::Index>& samples, PemRecording& recording) {
  const Eigen::Index channels = recording.noise_std.size(),
                     rows = static_cast<Eigen::Index>(recording.time_s.size()) * channels;
  if (samples.empty()) return;
  if (recording.weight.size() == 0) recording.weight = Eigen::VectorXd::Ones(rows);
  for (const Eigen::Index sample : samples) recording.weight.segment(sample * channels, channels).setZero();
}

std::vector<double> weights_of(const PemRecording& recording, Eigen::Index channel) {
  std::vector<double> weights(recording.time_s.size(), 1.0);
  for (std::size_t k = 0; recording.weight.size() > 0 && k < weights.size(); ++k)
    weights[k] = recording.weight(static_cast<Eigen::Index>(k) * recording.noise_std.size() + channel);
  return weights;
}

std::string name_in_recording(std::string_view parameter, std::size_t recording) {
  return std::string(parameter) + "@" + std::to_string(recording);
}

std::string parameter_of(const Unknown& unknown) { return unknown.name.substr(0, unknown.name.find('@')); }

double Unknown::to_unknown(double value) const { return logarithmic ? std::log(value / scale) : value / scale; }
double Unknown::to_value(double unknown) const { return logarithmic ? scale * std::exp(unknown) : scale * unknown; }
double Unknown::slope(double unknown) const { return logarithmic ? to_value(unknown) : scale; }

Result<PemProblem> make_pem_problem(const AssetConfig& asset, std::span<const TimeSeries> recordings,
                                    std::span<const int> groups, std::string_view own_parameter,
                                    std::span<const KnownValue> known) {
  PemProblem problem;
  for (const TimeSeries& recorded : recordings) {
    Result<PemRecording> recording = make_recording(asset, recorded, !groups.empty());
    if (!recording) return fail(recording.error());
    problem.recordings.push_back(std::move(*recording));
  }
  if (problem.recordings.empty()) return fail("there is no recording");
  Result<std::vector<Unknown>> shared =
      shared_unknowns(asset, *problem.recordings.front().simulation, own_parameter, known);
  if (!shared) return fail(shared.error());
  problem.shared = std::move(*shared);
  if (!own_parameter.empty() && groups.empty())
    if (const Status added = add_own_parameter(asset, own_parameter, problem); !added) return fail(added.error());
  if (groups.empty() || !problem.recordings.front().simulation->plant().has_load()) return problem;
  int last = -1;
  for (std::size_t k = 0; k < groups.size(); ++k) {
    problem.recordings[k].group = groups[k];
    if (groups[k] == last) continue;
    Result<Unknown> load = load_unknown(*problem.recordings[k].simulation);
    if (!load) return fail(load.error());
    load->group = last = groups[k];
    load->name += ":";
    load->name += std::to_string(last);
    problem.shared.push_back(std::move(*load));
  }
  return problem;
}

ModelValues values_at(const PemProblem& problem, std::size_t recording, const std::vector<double>& shared,
                      const std::vector<double>& own) {
  const PemRecording& part = problem.recordings[recording];
  ModelValues values = part.simulation->start();
  for (std::size_t k = 0; k < shared.size(); ++k)
    if (problem.shared[k].belongs_to(part.group))
      problem.shared[k].quantity.in(values) = problem.shared[k].to_value(shared[k]);
  for (std::size_t k = 0; k < own.size(); ++k) part.own[k].quantity.in(values) = part.own[k].to_value(own[k]);
  return values;
}

FreeOfRecording free_of(const PemProblem& problem, std::size_t recording, const std::vector<double>& shared,
                        const std::vector<double>& own, Derivatives derivatives) {
  const PemRecording& part = problem.recordings[recording];
  FreeOfRecording free;
  const auto add = [&](const std::vector<Unknown>& unknowns, const std::vector<double>& at) {
    for (std::size_t k = 0; k < at.size(); ++k) {
      if (derivatives == Derivatives::by_what_is_not_known && unknowns[k].is_known()) continue;
      const Eigen::Index column = free.columns++;
      if (!unknowns[k].belongs_to(part.group)) continue;
      free.quantity.push_back(unknowns[k].quantity);
      free.slope.push_back(unknowns[k].slope(at[k]));
      free.column.push_back(column);
    }
  };
  add(problem.shared, shared);
  add(part.own, own);
  return free;
}

namespace {

// Columns of unknowns that this recording does not have are zeros.
void widen(const FreeOfRecording& free, RowMatrix& jacobian) {
  if (free.columns == std::ssize(free.slope)) return;
  RowMatrix wide = RowMatrix::Zero(jacobian.rows(), free.columns);
  for (Eigen::Index row = 0; row < wide.rows(); ++row)
    for (std::size_t k = 0; k < free.column.size(); ++k)
      wide(row, free.column[k]) = jacobian(row, static_cast<Eigen::Index>(k));
  jacobian = std::move(wide);
}

// d value / d unknown, in the order of the Jacobian's columns.
Eigen::RowVectorXd slopes(const FreeOfRecording& free) {
  Eigen::RowVectorXd slope = Eigen::RowVectorXd::Zero(free.columns);
  for (std::size_t k = 0; k < free.column.size(); ++k) slope(free.column[k]) = free.slope[k];
  return slope;
}

// x <- factors (x - sum_j a_j x_(-j)), x_(-j) j times `past` before x; `total` grows by x.
SEALWATCH_WIDE_VECTORS
void whiten_row(std::span<const double> coefficients, Eigen::Index past, const double* factors, double weight,
                Eigen::Index count, double* x, double* total) {
  for (std::size_t j = 0; j < coefficients.size(); ++j) {
    const double a = coefficients[j], *before = x - static_cast<Eigen::Index>(j + 1) * past;
    for (Eigen::Index k = 0; k < count; ++k) x[k] -= a * before[k];
  }
  for (Eigen::Index k = 0; k < count; ++k) total[k] += x[k] *= weight * factors[k];
}

}  // namespace

// One pass over memory, backwards: what is before a row is as it was.
bool whiten_and_weigh(const RowsOfResiduals& rows, Linearisation& at) {
  const Eigen::Index channels = at.simulated.cols(), columns = at.jacobian.cols();
  Eigen::RowVectorXd total = Eigen::RowVectorXd::Zero(columns);
  double total_residual = 0.0;
  constexpr double kSame = 1.0;
  for (Eigen::Index row = at.residual.size() - 1; row >= 0; --row) {
    const Eigen::Index channel = row % channels, sample = row / channels;
    double weight = (rows.weight.size() == 0 ? 1.0 : rows.weight(row)) / rows.noise_std(channel);
    std::span<const double> coefficients;
    if (!rows.colour.empty()) {
      const ChannelColour& colour = rows.colour[static_cast<std::size_t>(channel)];
      if (!colour.coefficients.empty() && sample >= std::ssize(colour.coefficients)) {
        coefficients = colour.coefficients;
        weight /= colour.innovation_std;
      }
    }
    whiten_row(coefficients, channels, &kSame, weight, 1, at.residual.data() + row, &total_residual);
    whiten_row(coefficients, channels * columns, rows.slopes.data(), weight, columns,
               at.jacobian.data() + row * columns, total.data());
  }
  return std::isfinite(total_residual) && total.allFinite();
}

Result<Linearisation> linearise(const PemProblem& problem, std::size_t recording, const std::vector<double>& shared,
                                const std::vector<double>& own, Derivatives derivatives) {
  const PemRecording& part = problem.recordings[recording];
  const FreeOfRecording free = free_of(problem, recording, shared, own, derivatives);
  Result<SimulatedOutputs> outputs =
      part.simulation->run(values_at(problem, recording, shared, own), free.quantity, problem.simulation_options);
  if (!outputs) return fail(outputs.error());
  const RowMatrix residual = part.simulation->recorded() - outputs->values;
  Linearisation result{.simulated = std::move(outputs->values),
                       .residual = Eigen::Map<const Eigen::VectorXd>(residual.data(), residual.size()),
                       .jacobian = std::move(outputs->sensitivities)};
  widen(free, result.jacobian);
  if (!whiten_and_weigh({part.noise_std, part.colour, part.weight, -slopes(free)}, result))
    return fail("the simulation overflows");
  return result;
}

namespace {

// Places of a recording's unknowns that are known beforehand, and of the others, among all of them.
struct Places {
  std::vector<Eigen::Index> known, others;
};
Places places(const PemProblem& problem, Eigen::Index unknowns) {
  Places places;
  for (Eigen::Index k = 0; k < unknowns; ++k) {
    const auto shared = static_cast<std::size_t>(k);
    const bool known = shared < problem.shared.size() && problem.shared[shared].is_known();
    (known ? places.known : places.others).push_back(k);
  }
  return places;
}

// U with U'U = gram, which may be singular.
Eigen::MatrixXd root_of(const Eigen::MatrixXd& gram) {
  Eigen::VectorXd scale = gram.diagonal().cwiseSqrt();
  for (double& value : scale)
    if (!(value > 0.0)) value = 1.0;
  // Pivoted, so that columns that depend on each other only make a zero row.
  return dense::Symmetric(dense::scaled(gram, scale.cwiseInverse())).root() * scale.asDiagonal();
}

}  // namespace

KeptDerivatives kept_derivatives(const PemProblem& problem, const Linearisation& linearisation) {
  const Places of = places(problem, linearisation.jacobian.cols());
  KeptDerivatives kept{.jacobian = linearisation.jacobian(Eigen::all, of.known), .gram = {}};
  kept.gram = dense::gram_of_rows(kept.jacobian);
  return kept;
}

RowMatrix not_known_jacobian(const PemProblem& problem, const RowMatrix& whole) {
  return whole(Eigen::all, places(problem, whole.cols()).others);
}

RowMatrix whole_jacobian(const PemProblem& problem, const RowMatrix& not_known, const KeptDerivatives& kept) {
  const Places of = places(problem, not_known.cols() + kept.jacobian.cols());
  RowMatrix whole(not_known.rows(), not_known.cols() + kept.jacobian.cols());
  whole(Eigen::all, of.others) = not_known;
  whole(Eigen::all, of.known) = kept.jacobian;
  return whole;
}

Eigen::VectorXd jacobian_times(const PemProblem& problem, const Linearisation& at, const KeptDerivatives& kept,
                               const Eigen::VectorXd& v) {
  if (!at.has_kept) return at.jacobian * v;
  const Places of = places(problem, v.size());
  return at.jacobian * v(of.others) + kept.jacobian * v(of.known);
}

Eigen::VectorXd jacobian_transposed_times(const PemProblem& problem, const Linearisation& at,
                                          const KeptDerivatives& kept, const Eigen::VectorXd& y) {
  if (!at.has_kept) return at.jacobian.transpose() * y;
  const Places of = places(problem, at.jacobian.cols() + kept.jacobian.cols());
  Eigen::VectorXd product(at.jacobian.cols() + kept.jacobian.cols());
  product(of.others) = at.jacobian.transpose() * y;
  product(of.known) = kept.jacobian.transpose() * y;
  return product;
}

Eigen::MatrixXd compress(const Linearisation& linearisation) {
  const RowMatrix& jacobian = linearisation.jacobian;
  const Eigen::Index n = jacobian.cols();
  Eigen::MatrixXd gram(n + 1, n + 1);
  gram.topLeftCorner(n, n) = dense::gram_of_rows(jacobian);
  gram.col(n).head(n).noalias() = jacobian.transpose() * linearisation.residual;
  gram.row(n).head(n) = gram.col(n).head(n).transpose();
  gram(n, n) = linearisation.residual.squaredNorm();
  return root_of(gram);
}

Eigen::MatrixXd compress(const PemProblem& problem, const Linearisation& not_known, const KeptDerivatives& kept) {
  const Eigen::Index n = not_known.jacobian.cols() + kept.jacobian.cols();
  Places of = places(problem, n);
  of.others.push_back(n);  // the residual
  const auto [moving, mixed] = dense::products_beside(not_known.jacobian, not_known.residual, kept.jacobian);
  Eigen::MatrixXd gram(n + 1, n + 1);
  gram(of.others, of.others) = moving;
  gram(of.others, of.known) = mixed;
  gram(of.known, of.others) = mixed.transpose();
  gram(of.known, of.known) = kept.gram;
  return root_of(gram);
}

}  // namespace sealwatch

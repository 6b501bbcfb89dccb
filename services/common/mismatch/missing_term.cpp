#include "services/common/mismatch/missing_term.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "services/common/mismatch/site_words.hpp"
#include "services/common/mismatch/smooth_input.hpp"
#include "services/common/mismatch/term_path.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kBand = 1.96;         // standard errors: 95 %
constexpr double kStepsPerKnot = 8.0;  // of the integrator: hats have corners that it does not know of
constexpr std::string_view kSensor = "sensor:";

// The model without the effect at one recording.
struct Base {
  std::optional<PemProblem> problem;  ///< of this recording alone; none: that of the model without the effect
  std::vector<double> shared, own;
  SimulatedPoint at;
};

std::vector<double> own_values(const PemProblem& problem, const SimulatedPoint& like) {
  const std::vector<Unknown>&own = problem.recordings.front().own, &from = like.problem->recordings[like.recording].own;
  std::vector<double> values;
  for (const Unknown& unknown : own) {
    double value = unknown.start;
    for (std::size_t k = 0; k < from.size(); ++k)
      if (from[k].name == unknown.name) value = from[k].to_value(like.own[k]);
    values.push_back(unknown.to_unknown(value));
  }
  return values;
}

AssetConfig without_law(AssetConfig asset, const Law& law, const std::string& element) {
  std::erase_if(asset.physics, [&](const PhysicsTerm& term) { return term.id == law.id && term.element == element; });
  return asset;
}

// The model with the effect, less the law; the recording's own unknowns at their best where that can be found.
Status less_law(const FittedModel& with, const Data& data, std::size_t recording, const std::string& element,
                const Law& law, bool refit, Base& base) {
  const AssetConfig asset = with_fixed_parameters(without_law(with.asset, law, element));
  Result<PemProblem> problem = make_pem_problem(asset, std::span(data.samples).subspan(recording, 1));
  if (!problem) return fail(problem.error());
  if (!data.colour.empty()) problem->recordings.front().colour = data.colour[recording];
  problem->simulation_options = with.problem.simulation_options;
  base.problem = std::move(*problem);
  base.own = own_values(*base.problem, point_of(with, recording));
  if (refit) {
    ActuatorFitOptions options;
    options.hopeless_rms = 1e9;  // without the effect it may fit as badly as it likes
    if (const auto found = search(*base.problem, {.shared = {}, .own = {base.own}}, options))
      base.own = found->point.own.front();
  }
  base.at = {&*base.problem, 0, base.shared, base.own};
  return {};
}

std::size_t channel_of(const PlantSimulation& simulation, const std::string& element) {
  const auto channels = simulation.channels();
  const std::string name = element.starts_with(kSensor) ? element.substr(kSensor.size()) : element;
  return static_cast<std::size_t>(std::ranges::find(channels, name) - channels.begin());
}

tl::unexpected<Error> no_such_place(const std::string& element, const PlantSimulation& simulation) {
  return fail(Error{.file = {},
                    .place = element,
                    .value = {},
                    .rule = "is neither an element nor a recorded sensor of " + simulation.plant().name,
                    .advice = {}});
}

// Whitened residual, own columns and hat columns of the recording.
struct Columns {
  RowMatrix own, hats;
  Eigen::VectorXd residual;
};

Result<Columns> columns_of(const SimulatedPoint& at, const Knots& knots, const std::vector<std::size_t>& sites,
                           std::size_t sensor) {
  const PemRecording& part = at.problem->recordings[at.recording];
  std::vector<FreeQuantity> free;
  for (const Unknown& unknown : part.own) free.push_back(unknown.quantity);
  HatColumns hats(knots, sites);
  SimulationOptions options = at.problem->simulation_options;
  options.maximum_step_s = std::min(options.maximum_step_s, knots.spacing_s / kStepsPerKnot);
  const std::vector<double> shared(at.shared.begin(), at.shared.end()), own(at.own.begin(), at.own.end());
  auto run = part.simulation->run(values_at(*at.problem, at.recording, shared, own), free, options,
                                  sites.empty() ? nullptr : &hats);
  if (!run) return fail(run.error());

  const Eigen::Index channels = run->values.cols(), rows = run->values.rows() * channels;
  const auto unknowns = static_cast<Eigen::Index>(free.size()), count = static_cast<Eigen::Index>(knots.count);
  Linearisation all{.simulated = std::move(run->values),
                    .residual = Eigen::VectorXd(rows),
                    .jacobian = RowMatrix::Zero(rows, unknowns + count)};
  for (Eigen::Index row = 0; row < rows; ++row) {
    const Eigen::Index channel = row % channels, sample = row / channels;
    const double weight = 1.0 / part.noise_std(channel);
    all.residual(row) = weight * (part.simulation->recorded()(sample, channel) - all.simulated(sample, channel));
    const Eigen::Index known = run->sensitivities.cols();
    all.jacobian.row(row).head(known) = weight * run->sensitivities.row(row);
    if (!sites.empty() || channel != static_cast<Eigen::Index>(sensor)) continue;
    const auto [knot, share] = knots.at(part.time_s[static_cast<std::size_t>(sample)]);
    all.jacobian(row, known + static_cast<Eigen::Index>(knot)) = weight * (1.0 - share);
    all.jacobian(row, known + static_cast<Eigen::Index>(knot) + 1) = weight * share;
  }
  run->sensitivities.resize(0, 0);
  whiten(part.colour, all);
  if (!all.residual.allFinite() || !all.jacobian.allFinite()) return fail("the simulation overflows");
  return Columns{.own = all.jacobian.leftCols(unknowns),
                 .hats = all.jacobian.rightCols(count),
                 .residual = std::move(all.residual)};
}

Result<std::vector<double>> simulated_channel(const SimulatedPoint& at, std::size_t channel) {
  const std::vector<double> shared(at.shared.begin(), at.shared.end()), own(at.own.begin(), at.own.end());
  const auto run = at.problem->recordings[at.recording].simulation->run(
      values_at(*at.problem, at.recording, shared, own), {}, at.problem->simulation_options);
  if (!run) return fail(run.error());
  const Eigen::VectorXd column = run->values.col(static_cast<Eigen::Index>(channel));
  return std::vector<double>(column.begin(), column.end());
}

// What a sensor's law makes of its channel: its simulation with it less that without it, all else equal.
Status add_sensor_law(const FittedModel& with, const Data& data, std::size_t recording, const Law& law,
                      std::size_t channel, const Knots& knots, MissingTerm& term) {
  Base base;
  if (const Status made = less_law(with, data, recording, term.element, law, false, base); !made)
    return fail(made.error());
  auto read = simulated_channel(point_of(with, recording), channel);
  const auto true_value = simulated_channel(base.at, channel);
  if (!read || !true_value) return fail(read ? true_value.error() : read.error());
  for (std::size_t k = 0; k < read->size(); ++k) (*read)[k] -= (*true_value)[k];
  term.law = hat_means(knots, with.problem.recordings[recording].time_s, *read);
  return {};
}

Status describe_sensor(const SimulatedPoint& at, std::size_t channel, const Knots& knots, MissingTerm& term) {
  const PemRecording& part = at.problem->recordings[at.recording];
  const auto simulated = simulated_channel(at, channel);
  if (!simulated) return fail(simulated.error());
  term.state_value = hat_means(knots, part.time_s, *simulated);
  if (const auto* description = part.simulation->plant().find_channel(part.simulation->channels()[channel])) {
    term.unit = term.state_unit = description->unit;
    term.state = description->meaning;
  }
  return {};
}

Status describe_site(const SimulatedPoint& at, SiteKind kind, const Law* law, std::span<const double> parameters,
                     const Knots& knots, MissingTerm& term) {
  const auto path = term_path(at, term.element, kind, law, parameters, knots.spacing_s / kStepsPerKnot);
  if (!path) return fail(path.error());
  std::vector<double> state;
  for (const auto& signals : path->signals) state.push_back(signals.front());
  term.state_value = hat_means(knots, path->time_s, state);
  if (law != nullptr) term.law = hat_means(knots, path->time_s, path->contribution);
  term.unit = words_of(kind).unit;
  term.state = words_of(kind).signals.front().name;
  term.state_unit = words_of(kind).signals.front().unit;
  return {};
}

}  // namespace

Result<MissingTerm> missing_term(const FittedModel& without, const FittedModel* with, const Data& data,
                                 std::size_t recording, const std::string& element, SiteKind kind, const Law* law,
                                 std::span<const double> parameters) {
  const bool sensor = is_sensor(kind), found = with != nullptr && law != nullptr;
  Base base;
  base.at = point_of(without, recording);
  if (found)
    if (const Status made = less_law(*with, data, recording, element, *law, true, base); !made)
      return fail(made.error());
  const PemRecording& part = base.at.problem->recordings[base.at.recording];
  const std::vector<std::size_t> sites = sites_of(*part.simulation, element, kind);
  const std::size_t channel = sensor ? channel_of(*part.simulation, element) : 0;
  if (sensor ? channel == part.simulation->channels().size() : sites.empty())
    return no_such_place(element, *part.simulation);

  MissingTerm term;
  term.element = element;
  term.recording = data.names[recording];
  const Knots knots = make_knots(part.time_s);
  Result<Columns> columns = columns_of(base.at, knots, sites, channel);
  if (!columns) return fail(columns.error());
  const auto input = smooth_input(std::move(columns->hats), columns->own, std::move(columns->residual));
  if (!input) return fail(input.error());

  const SimulatedPoint drawn = found ? point_of(*with, recording) : base.at;
  Status status = sensor ? describe_sensor(drawn, channel, knots, term)
                         : describe_site(drawn, kind, found ? law : nullptr, parameters, knots, term);
  if (status && sensor && found) status = add_sensor_law(*with, data, recording, *law, channel, knots, term);
  if (!status) return fail(status.error());

  term.quantity = words_of(kind).quantity;
  if (!input->level_known) term.quantity += ", up to a constant";
  const bool anchored = !input->level_known && !term.law.empty();
  const double level =
      anchored ? std::accumulate(term.law.begin(), term.law.end(), 0.0) / static_cast<double>(term.law.size()) : 0.0;
  for (std::size_t k = 0; k < knots.count; ++k) {
    term.time_s.push_back(knots.time_s(k));
    term.demanded.push_back(level + input->value(static_cast<Eigen::Index>(k)));
    term.band.push_back(kBand * input->standard_error(static_cast<Eigen::Index>(k)));
  }
  return term;
}

}  // namespace sealwatch::mismatch

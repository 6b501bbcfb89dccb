#include "services/common/mismatch/missing_term.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "services/common/mismatch/candidates.hpp"
#include "services/common/mismatch/site_words.hpp"
#include "services/common/mismatch/smooth_input.hpp"
#include "services/common/mismatch/term_path.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kBand = 1.96;         // standard errors: 95 %
constexpr double kStepsPerKnot = 8.0;  // of the integrator: hats have corners that it does not know of

tl::unexpected<Error> no_such_place(const std::string& element, const PlantSimulation& simulation) {
  return fail(Error{.file = {},
                    .place = element,
                    .value = {},
                    .rule = "is neither an element nor a recorded sensor of " + simulation.plant().name,
                    .advice = {}});
}

ModelValues values_of(const SimulatedPoint& at) {
  return values_at(*at.problem, at.recording, {at.shared.begin(), at.shared.end()}, {at.own.begin(), at.own.end()});
}

// Load and initial states; the load is the recording's own even where windows of a recording share it.
std::vector<FreeQuantity> own_quantities(const SimulatedPoint& at, const ModelValues& values) {
  const PemRecording& part = at.problem->recordings[at.recording];
  std::vector<FreeQuantity> own;
  bool load = false;
  for (const Unknown& unknown : part.own) {
    own.push_back(unknown.quantity);
    load = load || unknown.quantity.kind != FreeQuantity::Kind::initial_state;
  }
  if (load || !part.simulation->plant().has_load()) return own;
  const FreeQuantity mean = *part.simulation->find(part.simulation->plant().load_parameter);
  own.push_back(mean.in(values) != 0.0 ? *part.simulation->find("load_factor") : mean);
  return own;
}

// Whitened residual, own columns and hat columns of the recording.
struct Columns {
  RowMatrix own, hats;
  Eigen::VectorXd residual;
};

Result<Columns> columns_of(const SimulatedPoint& at, const Knots& knots, const std::vector<std::size_t>& sites,
                           std::size_t sensor) {
  const PemRecording& part = at.problem->recordings[at.recording];
  const ModelValues values = values_of(at);
  const std::vector<FreeQuantity> free = own_quantities(at, values);
  HatColumns hats(knots, sites);
  SimulationOptions options = at.problem->simulation_options;
  options.maximum_step_s = std::min(options.maximum_step_s, knots.spacing_s / kStepsPerKnot);
  auto run = part.simulation->run(values, free, options, sites.empty() ? nullptr : &hats);
  if (!run) return fail(run.error());

  const Eigen::Index channels = run->values.cols(), rows = run->values.rows() * channels;
  const auto unknowns = static_cast<Eigen::Index>(free.size()), count = static_cast<Eigen::Index>(knots.count);
  Linearisation all{.simulated = std::move(run->values),
                    .residual = Eigen::VectorXd(rows),
                    .jacobian = RowMatrix::Zero(rows, unknowns + count)};
  for (Eigen::Index row = 0; row < rows; ++row) {
    const Eigen::Index channel = row % channels, sample = row / channels;
    all.residual(row) = part.simulation->recorded()(sample, channel) - all.simulated(sample, channel);
    const Eigen::Index known = run->sensitivities.cols();
    all.jacobian.row(row).head(known) = run->sensitivities.row(row);
    if (!sites.empty() || channel != static_cast<Eigen::Index>(sensor)) continue;
    const auto [knot, share] = knots.at(part.time_s[static_cast<std::size_t>(sample)]);
    all.jacobian(row, known + static_cast<Eigen::Index>(knot)) = 1.0 - share;
    all.jacobian(row, known + static_cast<Eigen::Index>(knot) + 1) = share;
  }
  run->sensitivities.resize(0, 0);
  const Eigen::VectorXd no_weight;
  if (!whiten_and_weigh({part.noise_std, part.colour, no_weight, Eigen::RowVectorXd::Ones(all.jacobian.cols())}, all))
    return fail("the simulation overflows");
  return Columns{.own = all.jacobian.leftCols(unknowns),
                 .hats = all.jacobian.rightCols(count),
                 .residual = std::move(all.residual)};
}

void describe_law(const TermPath& path, const std::vector<double>& state, const Knots& knots, MissingTerm& term) {
  term.law = hat_means(knots, path.time_s, path.contribution);
  term.path_state = state;
  term.path_law = path.contribution;
}

Status describe_sensor(const SimulatedPoint& at, std::size_t channel, const Law* law, const Knots& knots,
                       MissingTerm& term) {
  const PemRecording& part = at.problem->recordings[at.recording];
  const auto path = sensor_path(at, term.element, law);
  if (!path) return fail(path.error());
  std::vector<double> measured;
  for (const auto& signals : path->signals) measured.push_back(signals.front());
  term.state_value = hat_means(knots, path->time_s, measured);
  if (law != nullptr) describe_law(*path, measured, knots, term);
  if (const auto* description = part.simulation->plant().find_channel(part.simulation->channels()[channel])) {
    term.unit = term.state_unit = description->unit;
    term.state = description->meaning;
  }
  return {};
}

Status describe_site(const SimulatedPoint& at, SiteKind kind, const Law* law, std::span<const double> parameters,
                     std::size_t signal, const Knots& knots, MissingTerm& term) {
  const auto path = term_path(at, term.element, kind, law, parameters, knots.spacing_s / kStepsPerKnot);
  if (!path) return fail(path.error());
  std::vector<double> state;
  for (const auto& signals : path->signals) state.push_back(signals[signal]);
  term.state_value = hat_means(knots, path->time_s, state);
  if (law != nullptr) describe_law(*path, state, knots, term);
  const PlantDescription& plant = at.problem->recordings[at.recording].simulation->plant();
  const SiteWords words = words_at(plant, term.element, kind);
  term.unit = words.unit;
  term.state = words.signals[signal].name;
  term.state_unit = words.signals[signal].unit;
  return {};
}

}  // namespace

Result<MissingTerm> missing_term(const FittedModel& without, const FittedModel* with, const Data& data,
                                 std::size_t recording, const std::string& element, SiteKind kind, const Law* law,
                                 std::span<const double> parameters, std::size_t signal) {
  if (with == nullptr) law = nullptr;
  const SimulatedPoint at = point_of(law == nullptr ? without : *with, recording);
  const PemRecording& part = at.problem->recordings[recording];
  const bool sensor = is_sensor(kind);
  const std::vector<std::size_t> sites = sites_of(*part.simulation, element, kind);
  const std::size_t channel = sensor ? channel_of(*part.simulation, element) : 0;
  if (sensor ? channel == part.simulation->channels().size() : sites.empty())
    return no_such_place(element, *part.simulation);

  MissingTerm term;
  term.element = element;
  term.recording = data.names[recording];
  const Knots knots = make_knots(part.time_s);
  const Status described = sensor ? describe_sensor(at, channel, law, knots, term)
                                  : describe_site(at, kind, law, parameters, signal, knots, term);
  if (!described) return fail(described.error());
  Result<Columns> columns = columns_of(at, knots, sites, channel);
  if (!columns) return fail(columns.error());
  if (!term.law.empty())  // given back: the data have to ask for it
    columns->residual += columns->hats * Eigen::Map<const Eigen::VectorXd>(term.law.data(), columns->hats.cols());
  const auto input = smooth_input(std::move(columns->hats), columns->own, std::move(columns->residual));
  if (!input) return fail(input.error());

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

void append(MissingTerm& term, MissingTerm&& next) {
  for (auto* path : {&term.path_state, &term.path_law})
    if (!path->empty()) path->push_back(std::numeric_limits<double>::quiet_NaN());
  for (std::vector<double> MissingTerm::*values :
       {&MissingTerm::time_s, &MissingTerm::state_value, &MissingTerm::demanded, &MissingTerm::band, &MissingTerm::law,
        &MissingTerm::path_state, &MissingTerm::path_law})
    (term.*values).insert((term.*values).end(), (next.*values).begin(), (next.*values).end());
}

}  // namespace sealwatch::mismatch

#include "services/common/mismatch/fitted_model.hpp"

#include <algorithm>
#include <cmath>

#include "sealwatch/model/law_sizes.hpp"
#include "services/common/dense/row_products.hpp"
#include "services/common/estimation/own_jumps.hpp"
#include "services/common/mismatch/criterion.hpp"
#include "services/common/mismatch/input_jumps.hpp"

namespace sealwatch::mismatch {
namespace {

ActuatorFitOptions search_options(int threads, int iterations) {
  ActuatorFitOptions options;
  options.maximum_iterations = iterations;
  options.hopeless_rms = 1e9;  // a bad fit is what is looked at here
  options.restart_factors = {};
  options.threads = threads;
  return options;
}

void set_value(AssetConfig& asset, const std::string& name, double value) {
  if (const auto parameter = asset.parameters.find(name); parameter != asset.parameters.end())
    parameter->second.value = value;
  for (auto& [channel, sensor] : asset.sensors) {
    if (name == sensor_gain_name(channel)) sensor.gain_error = value;
    if (name == sensor_offset_name(channel)) sensor.offset_error = value;
  }
  for (PhysicsTerm& term : asset.physics)
    for (auto& [parameter, setting] : term.parameters)
      if (physics_parameter_name(term.element, term.id, parameter) == name) setting.value = value;
}

double within_range(const Unknown& unknown, double value) {
  return unknown.max > unknown.min ? std::clamp(value, unknown.min, unknown.max) : value;
}

// Places of a problem's recordings among those of another fit; the same ones where none are given.
using Places = std::span<const std::size_t>;
std::size_t place_of(std::size_t recording, Places places) { return places.empty() ? recording : places[recording]; }

// Name in the problem of a shared unknown of another fit: what belongs to one recording ends in that one's number.
std::string name_among(const PemProblem& problem, Places places, const PemProblem& there, const Unknown& unknown) {
  if (places.empty() || unknown.group < 0) return unknown.name;
  const auto is_its = [&](std::size_t place) {
    return place < there.recordings.size() && there.recordings[place].group == unknown.group;
  };
  const auto place = std::ranges::find_if(places, is_its);
  if (place == places.end()) return {};
  const int group = problem.recordings[static_cast<std::size_t>(place - places.begin())].group;
  return unknown.name.substr(0, unknown.name.find_last_of("@:") + 1) + std::to_string(group);
}

// Where another fit of the same recordings ended, changed by `beside`; empty: as it is.
void continue_from(const FittedModel& start, const PemPoint& beside, Places places, const PemProblem& problem,
                   PemPoint& point) {
  for (std::size_t k = 0; k < start.problem.shared.size(); ++k) {
    const std::string name = name_among(problem, places, start.problem, start.problem.shared[k]);
    const auto same = std::ranges::find(problem.shared, name, &Unknown::name);
    if (same == problem.shared.end()) continue;
    const double change = beside.shared.empty() ? 0.0 : beside.shared[k],
                 value = start.problem.shared[k].to_value(start.optimum.point.shared[k] + change);
    point.shared[static_cast<std::size_t>(same - problem.shared.begin())] =
        same->to_unknown(change == 0.0 ? value : within_range(*same, value));
  }
  for (std::size_t r = 0; r < problem.recordings.size(); ++r) {
    const std::size_t there = place_of(r, places);
    if (there >= start.problem.recordings.size()) continue;
    for (std::size_t k = 0; k < problem.recordings[r].own.size(); ++k)
      for (std::size_t j = 0; j < start.problem.recordings[there].own.size(); ++j) {
        const Unknown& from = start.problem.recordings[there].own[j];
        if (from.name == problem.recordings[r].own[k].name)
          point.own[r][k] = problem.recordings[r].own[k].to_unknown(
              from.to_value(start.optimum.point.own[there][j] + (beside.own.empty() ? 0.0 : beside.own[there][j])));
      }
  }
}

bool same_noise(const PemRecording& a, const PemRecording& b) {
  const auto same_colour = [](const ChannelColour& x, const ChannelColour& y) {
    return x.coefficients == y.coefficients && x.innovation_std == y.innovation_std;
  };
  return a.time_s == b.time_s && a.noise_std == b.noise_std && std::ranges::equal(a.colour, b.colour, same_colour) &&
         a.weight.size() == b.weight.size() && a.weight == b.weight;
}

// Derivatives by what is known beforehand where another fit of the same recordings ended; none where that lacks some,
// or misses grossly.
std::vector<KeptDerivatives> derivatives_from(const FittedModel& start, Places places, const PemProblem& problem) {
  const bool same_run = start.problem.simulation_options.held_within_s == problem.simulation_options.held_within_s;
  if (excess(start) > kGross || !same_run) return {};
  const std::vector<Unknown>& known = start.problem.shared;
  std::vector<Eigen::Index> columns;
  std::vector<double> slopes;
  for (const Unknown& unknown : problem.shared) {
    if (!unknown.is_known()) continue;
    const auto same = std::ranges::find(known, unknown.name, &Unknown::name);
    if (same == known.end()) return {};
    const auto k = static_cast<std::size_t>(same - known.begin());
    const double at = start.optimum.point.shared[k];
    columns.push_back(static_cast<Eigen::Index>(k));
    slopes.push_back(unknown.slope(unknown.to_unknown(same->to_value(at))) / same->slope(at));
  }
  std::vector<KeptDerivatives> kept;
  for (std::size_t k = 0; k < problem.recordings.size(); ++k) {
    const std::size_t there = place_of(k, places);
    const bool same = there < start.problem.recordings.size() &&
                      (!places.empty() || start.problem.recordings.size() == problem.recordings.size()) &&
                      same_noise(start.problem.recordings[there], problem.recordings[k]);
    if (!same || start.optimum.at_optimum[there].jacobian.size() == 0) return {};
    kept.push_back({start.optimum.at_optimum[there].jacobian(Eigen::all, columns), {}});
    kept.back().jacobian *= Eigen::Map<const Eigen::VectorXd>(slopes.data(), std::ssize(slopes)).asDiagonal();
    kept.back().gram = dense::gram_of_rows(kept.back().jacobian);
  }
  return kept;
}

// Of simulations that miss by the root of `excess` times the noise. Errors of a free run add up; one that is held forgets
// them, and follows the recording's noise.
double tolerance_at(double excess, double held_within_s) {
  constexpr double kFarOff = 100.0;  // times the noise: nearer, it decides what is told apart
  constexpr double kHeld = 10.0, kCoarsest = 1e-4;
  const double free_run = SimulationOptions{}.relative_tolerance,
               finest = held_within_s > 0.0 ? kHeld * free_run : free_run;
  return std::clamp(free_run * std::sqrt(excess) / kFarOff, finest, kCoarsest);
}

// `from`: where the search sets out; null: not known.
Result<PemProblem> problem_of(const AssetConfig& asset, const Data& data, const ActuatorFitOptions& options,
                              const FittedModel* from) {
  Result<PemProblem> problem = make_pem_problem(asset, data.samples, data.groups, data.own_parameter, data.known);
  if (!problem) return problem;
  for (std::size_t k = 0; k < data.colour.size(); ++k) problem->recordings[k].colour = data.colour[k];
  for (std::size_t k = 0; k < data.samples.size(); ++k) {
    PemRecording& recording = problem->recordings[k];
    if (!data.weight.empty() && data.weight[k].size() > 0)
      recording.weight = recording.weight.size() == 0 ? data.weight[k] : data.weight[k].cwiseProduct(recording.weight);
    leave_out(samples_after_jumps(data.samples[k], recording.simulation->plant()), recording);
    if (data.start_as_measured)
      std::erase_if(recording.own, [](const Unknown& unknown) { return unknown.name.starts_with("initial:"); });
  }
  // No value can go astray where none is searched: only a plant that is fast between samples takes so many steps.
  constexpr double kMoreSteps = 10.0;
  ActuatorFitOptions as_asked = options;
  if (problem->shared.empty()) as_asked.steps_per_sample *= kMoreSteps;
  problem->simulation_options = simulation_options(data.samples, as_asked);
  problem->simulation_options.relative_tolerance = from != nullptr && from->residuals > 0.0
                                                       ? tolerance_at(excess(*from), data.held_within_s)
                                                       : data.relative_tolerance;
  problem->simulation_options.deadline = data.deadline;
  problem->simulation_options.held_within_s = data.held_within_s;
  return problem;
}

FittedModel model_at(const AssetConfig& asset, PemProblem problem, PemOptimum optimum) {
  FittedModel model{.asset = asset, .problem = std::move(problem), .optimum = std::move(optimum)};
  for (std::size_t k = 0; k < model.problem.shared.size(); ++k) {
    const Unknown& unknown = model.problem.shared[k];
    set_value(model.asset, parameter_of(unknown),
              within_range(unknown, unknown.to_value(model.optimum.point.shared[k])));
    if (unknown.is_known())
      model.misfit += std::pow(unknown.prior_residual(model.optimum.point.shared[k]), 2);
    else if (!at_bound(unknown, model.optimum.point.shared[k]))
      ++model.free_shared;
  }
  for (std::size_t k = 0; k < model.optimum.at_optimum.size(); ++k) {
    const Linearisation& at = model.optimum.at_optimum[k];
    const auto known = model.problem.recordings[k].noise_std.array().isFinite().count();
    model.misfit += at.residual.squaredNorm();
    model.residuals += static_cast<double>(at.simulated.rows() * known);
  }
  return model;
}

// The search goes on where it ended nearer to the recordings than its simulations were exact for. Where that fails, as its
// time is up, what it had stays.
FittedModel as_exact_as_it_fits(FittedModel model, const Data& data, int threads, int iterations,
                                const SearchBound& bound) {
  if (is_exact_enough(model)) return model;
  Result<FittedModel> exact = continue_fit(model, data, threads, iterations, bound);
  return exact ? std::move(*exact) : std::move(model);
}

Result<FittedModel> fit_from(const FittedModel& start, const PemPoint& beside, const AssetConfig& asset,
                             const Data& data, int threads, int iterations, const SearchBound& bound,
                             Places places = {}) {
  const ActuatorFitOptions options = search_options(threads, iterations);
  Result<PemProblem> problem = problem_of(asset, data, options, &start);
  if (!problem) return fail(problem.error());
  PemPoint point = start_point(*problem, 1.0);
  continue_from(start, beside, places, *problem, point);
  Result<PemOptimum> optimum =
      search(*problem, std::move(point), options, {.kept = derivatives_from(start, places, *problem), .bound = bound});
  if (!optimum) return fail(optimum.error());
  return model_at(asset, std::move(*problem), std::move(*optimum));
}

}  // namespace

bool is_exact_enough(const FittedModel& model) {
  constexpr double kEnough = 3.0;
  return model.problem.simulation_options.relative_tolerance <= kEnough * tolerance_for(model);
}

double tolerance_for(const FittedModel& model) {
  return tolerance_at(excess(model), model.problem.simulation_options.held_within_s);
}

bool at_bound(const Unknown& unknown, double at) {
  constexpr double kNear = 1e-6;
  return at - unknown.to_unknown(unknown.min) < kNear || unknown.to_unknown(unknown.max) - at < kNear;
}

Result<FittedModel> fit_model(const AssetConfig& asset, const Data& data, const FittedModel* start, int threads,
                              int iterations, const SearchBound& bound) {
  if (start != nullptr) {
    Result<FittedModel> model = fit_from(*start, {}, asset, data, threads, iterations, bound);
    if (!model) return model;
    return as_exact_as_it_fits(std::move(*model), data, threads, iterations, bound);
  }
  ActuatorFitOptions options = search_options(threads, iterations);
  Result<PemProblem> problem = problem_of(asset, data, options, nullptr);
  if (!problem) return fail(problem.error());
  // A model that lacks physics often does not converge, and pieces, with states of their own, hide what it lacks: they
  // are for values with which nothing can be simulated.
  const auto jumps = [&] { return has_own_jumps(*problem->recordings.front().simulation, data.samples.front()); };
  // One that jumps is not asked for what it lacks, and ends in the nearest of many minima: as `fit` does, from beginnings.
  options.cut_into_pieces = data.groups.empty() && jumps();
  Result<PemOptimum> optimum = search_from_asset(*problem, asset, data.samples, options);
  const bool again = !optimum && !options.cut_into_pieces;
  options.cut_into_pieces = data.groups.empty();  // else they are pieces already
  if (again && options.cut_into_pieces) optimum = search_from_asset(*problem, asset, data.samples, options);
  if (!optimum) return fail(optimum.error());
  return as_exact_as_it_fits(model_at(asset, std::move(*problem), std::move(*optimum)), data, threads, iterations,
                             bound);
}

Result<FittedModel> fit_model_beside(const PemPoint& beside, const AssetConfig& asset, const Data& data,
                                     const FittedModel& start, int threads, int iterations, const SearchBound& bound) {
  return fit_from(start, beside, asset, data, threads, iterations, bound);
}

Result<FittedModel> fit_to_some(const FittedModel& model, const Data& data, std::span<const std::size_t> places,
                                int threads, int iterations) {
  return fit_to_some(model, model.asset, data, places, threads, iterations);
}

Result<FittedModel> fit_to_some(const FittedModel& model, const AssetConfig& asset, const Data& data,
                                std::span<const std::size_t> places, int threads, int iterations) {
  Result<FittedModel> refitted = fit_from(model, {}, asset, data, threads, iterations, {}, places);
  if (!refitted) return refitted;
  return as_exact_as_it_fits(std::move(*refitted), data, threads, iterations, {});
}

Result<FittedModel> continue_fit(const FittedModel& model, const Data& data, int threads, int iterations,
                                 const SearchBound& bound) {
  const ActuatorFitOptions options = search_options(threads, iterations);
  Result<PemProblem> problem = problem_of(model.asset, data, options, &model);
  if (!problem) return fail(problem.error());
  // The point and the derivatives there are in the unknowns of the search that ended: a logarithm's zero is where that
  // one set out.
  problem->shared = model.problem.shared;
  for (std::size_t k = 0; k < problem->recordings.size(); ++k)
    problem->recordings[k].own = model.problem.recordings[k].own;
  const bool known = model.optimum.at_optimum.front().jacobian.size() > 0 && is_exact_enough(model);
  KnownBefore before{.bound = bound};
  if (known) before.at_start = model.optimum.at_optimum;
  Result<PemOptimum> optimum = search(*problem, model.optimum.point, options, std::move(before));
  if (!optimum) return fail(optimum.error());
  FittedModel further = model_at(model.asset, std::move(*problem), std::move(*optimum));
  return as_exact_as_it_fits(std::move(further), data, threads, iterations, bound);
}

const Linearisation& linearised(const FittedModel& model, std::size_t recording, std::optional<Linearisation>& anew) {
  const Linearisation& kept = model.optimum.at_optimum[recording];
  if (kept.jacobian.size() > 0) return kept;
  Result<Linearisation> again =
      linearise(model.problem, recording, model.optimum.point.shared, model.optimum.point.own[recording]);
  return again ? anew.emplace(std::move(*again)) : kept;
}

AssetConfig with_fixed_parameters(AssetConfig asset) {
  for (auto& [name, setting] : asset.parameters) setting.estimate = false;
  for (PhysicsTerm& term : asset.physics)
    for (auto& [name, setting] : term.parameters) setting.estimate = false;
  return asset;
}

AssetConfig with_law(AssetConfig asset, const Law& law, const std::string& element,
                     std::span<const double> parameters) {
  PhysicsTerm term{.id = std::string(law.id), .element = element, .parameters = {}};
  const PlantDescription& plant = **find_plant(asset.model);
  for (std::size_t k = 0; k < law.parameters.size(); ++k) {
    const LawParameter& parameter = law.parameters[k];
    const LawBounds bounds = law_bounds(plant, parameter);
    const bool whole = parameter.unit == "1/rev" || (law.hidden && law.hidden->shaft_angle && !parameter.strength);
    term.parameters[std::string(parameter.name)] = {.value = std::clamp(parameters[k], bounds.min, bounds.max),
                                                    .min = bounds.min,
                                                    .max = bounds.max,
                                                    .estimate = !whole};
  }
  asset.physics.push_back(std::move(term));
  return asset;
}

std::optional<double> estimate_of(const FittedModel& model, const std::string& name) {
  for (std::size_t k = 0; k < model.problem.shared.size(); ++k)
    if (model.problem.shared[k].name == name) return model.problem.shared[k].to_value(model.optimum.point.shared[k]);
  return std::nullopt;
}

}  // namespace sealwatch::mismatch

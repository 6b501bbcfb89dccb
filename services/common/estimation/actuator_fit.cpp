#include "sealwatch/estimation/actuator_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sealwatch/estimation/cylinder_circuit.hpp"
#include "services/common/estimation/cannot_fit.hpp"
#include "services/common/estimation/fit_report.hpp"
#include "services/common/estimation/growing_start.hpp"
#include "services/common/estimation/interpolation_error.hpp"
#include "services/common/estimation/own_jumps.hpp"
#include "services/common/estimation/pem_search.hpp"
#include "services/common/estimation/piecewise_start.hpp"
#include "services/common/model/plants/eha_switched/estimation/closed_valves.hpp"
#include "services/common/text/numbers.hpp"

namespace sealwatch {
namespace {

// Seal leakage and bulk modulus from the cylinder circuit, where it can be fitted: one linear regression instead of a
// step from the asset's value, which overshoots where the seal is worn.
void start_from_cylinder_circuit(PemProblem& problem, const AssetConfig& asset,
                                 std::span<const TimeSeries> recordings) {
  if (!has_cylinder_circuit(asset)) return;
  for (const TimeSeries& recorded : recordings) {
    const FitReport circuit = fit_cylinder_circuit(asset, recorded, {});
    if (!circuit.admissible) continue;
    for (const EstimatedParameter& parameter : circuit.parameters)
      for (Unknown& unknown : problem.shared)
        if (unknown.name == parameter.name) unknown.start = parameter.value;
    return;
  }
}

// Half the sum of squares at the starting values; infinite where they cannot be simulated.
double cost_at_start(const PemProblem& problem) {
  const PemPoint start = start_point(problem, 1.0);
  double cost = 0.0;
  for (std::size_t k = 0; k < problem.recordings.size(); ++k) {
    const Result<Linearisation> at = linearise(problem, k, start.shared, start.own[k]);
    if (!at) return std::numeric_limits<double>::infinity();
    cost += 0.5 * at->residual.squaredNorm();
  }
  return cost;
}

// Seal leakage by trying values from the asset's down to a tenth: without a flow sensor the circuit cannot be fitted,
// and from a new seal's value the search ends in a wrong minimum where the seal is worn.
void start_from_best_leakage(PemProblem& problem, const PlantDescription& plant) {
  constexpr double kStep = 0.75;
  constexpr int kSteps = 8;
  if (!plant.condition) return;
  const auto leakage = std::ranges::find(problem.shared, plant.condition->parameter, &Unknown::name);
  if (leakage == problem.shared.end()) return;
  double best = leakage->start;
  double least = cost_at_start(problem);
  for (int step = 1; step <= kSteps; ++step) {
    leakage->start *= kStep;
    if (leakage->start < leakage->min) break;
    const double cost = cost_at_start(problem);
    if (cost < least) {
      least = cost;
      best = leakage->start;
    }
  }
  leakage->start = best;
}

// Whether the search ended farther from the recordings than a right model can.
bool is_far(const PemOptimum& optimum, const ActuatorFitOptions& options) {
  double residuals = 0.0;
  for (const Linearisation& at : optimum.at_optimum) residuals += static_cast<double>(at.residual.size());
  const double rms = options.admissibility.largest_noise_normalised_rms;
  return optimum.cost > 0.5 * residuals * rms * rms;
}

bool better(const PemOptimum& a, const PemOptimum& b, const ActuatorFitOptions& options) {
  if (const bool a_far = is_far(a, options); a_far != is_far(b, options)) return !a_far;
  return a.converged != b.converged ? a.converged : a.cost < b.cost;
}

// From the asset's values; where nothing can be simulated with them, or the search does not converge, from those of the
// recordings' pieces, then from multiples of the asset's. A plant of one's own, of which nothing better is known, also
// from those of the recordings' pieces, where it jumps, and of their beginnings where the search converged far off.
Result<PemOptimum> search_from_several_starts(const PemProblem& problem, const AssetConfig& asset,
                                              std::span<const TimeSeries> recordings,
                                              const ActuatorFitOptions& options) {
  Result<PemOptimum> best = search(problem, start_point(problem, 1.0), options);
  if (problem.shared.empty() || (best && best->hopeless)) return best;
  const bool may_grow = options.cut_into_pieces && !plant_or_default(asset.model).file.empty();
  const auto wrong = [&] {
    if (passed(options.deadline)) return false;
    return !best || !best->converged || (may_grow && is_far(*best, options));
  };
  if (!wrong()) return best;
  const auto take_better = [&](Result<PemOptimum> other) {
    if (other && (!best || better(*other, *best, options))) best = std::move(other);
  };
  const bool jumps = has_own_jumps(*problem.recordings.front().simulation, recordings.front());
  if (options.cut_into_pieces && (!(best && best->converged) || (jumps && wrong())))
    if (auto start = piecewise_start(problem, asset, recordings, options))
      take_better(search(problem, std::move(*start), options));
  if (may_grow && wrong())
    if (auto start = growing_start(problem, asset, recordings, options))
      take_better(search(problem, std::move(*start), options));
  for (const double factor : options.restart_factors) {
    if ((best && best->converged) || passed(options.deadline)) break;
    take_better(search(problem, start_point(problem, factor), options));
  }
  return best;
}

}  // namespace

SimulationOptions simulation_options(std::span<const TimeSeries> recordings, const ActuatorFitOptions& options) {
  constexpr double kFewestSteps = 10000.0;  // short recordings start from rest at high resolution
  SimulationOptions simulation;
  std::size_t samples = 0;
  double fewest_steps = kFewestSteps;
  for (const TimeSeries& recorded : recordings) {
    samples = std::max(samples, recorded.time_s.size());
    if (recorded.time_s.empty()) continue;
    const double duration_s = recorded.time_s.back() - recorded.time_s.front();
    fewest_steps = std::max(fewest_steps, kFewestSteps + duration_s / kLongestStep_s);
  }
  simulation.deadline = options.deadline;
  simulation.maximum_steps =
      static_cast<std::size_t>(fewest_steps + options.steps_per_sample * static_cast<double>(samples));
  return simulation;
}

Result<PemOptimum> search_from_asset(PemProblem& problem, const AssetConfig& asset,
                                     std::span<const TimeSeries> recordings, const ActuatorFitOptions& options) {
  start_from_cylinder_circuit(problem, asset, recordings);
  const PlantDescription& plant = plant_or_default(asset.model);
  if (std::ranges::none_of(recordings,
                           [&](const TimeSeries& one) { return find_series(one, plant, ChannelRole::flow); }))
    start_from_best_leakage(problem, plant);
  return search_from_several_starts(problem, asset, recordings, options);
}

Status ActuatorFitOptions::validate() const {
  if (maximum_iterations < 1)
    return fail("maximum_iterations must be at least 1, is " + std::to_string(maximum_iterations));
  if (threads < 1) return fail("threads must be at least 1, is " + std::to_string(threads));
  if (!(cost_tolerance > 0.0)) return fail("cost_tolerance must be positive, is " + text::significant(cost_tolerance));
  if (!(hopeless_rms > admissibility.largest_noise_normalised_rms))
    return fail("hopeless_rms must be above largest_noise_normalised_rms, is " + text::significant(hopeless_rms));
  if (!(steps_per_sample > 0.0))
    return fail("steps_per_sample must be positive, is " + text::significant(steps_per_sample));
  for (const double factor : restart_factors)
    if (!(factor > 0.0)) return fail("restart_factors must be positive, one is " + text::significant(factor));
  return admissibility.validate();
}

JointFit fit_actuator(const AssetConfig& asset, std::span<const TimeSeries> recordings,
                      const ActuatorFitOptions& options) {
  const auto failed = [&](const Error& error) {
    return JointFit{.report = cannot_fit(asset.model, error.describe()), .recordings = {}};
  };
  if (const Status valid = options.validate(); !valid) return failed(valid.error());
  Result<PemProblem> problem = make_pem_problem(asset, recordings);
  if (!problem) return failed(problem.error());
  problem->simulation_options = simulation_options(recordings, options);
  Result<PemOptimum> optimum = search_from_asset(*problem, asset, recordings, options);
  const bool input_matters = optimum && !optimum->hopeless && !passed(options.deadline) &&
                             add_interpolation_error(*problem, *optimum, asset, recordings);
  if (input_matters) {
    const int iterations = optimum->iterations;
    Result<PemOptimum> whitened = search(*problem, optimum->point, options);
    if (whitened || !passed(options.deadline)) optimum = std::move(whitened);
    if (optimum) optimum->iterations += iterations;
  }
  if (!optimum) return failed(optimum.error());
  JointFit fit = report_fit(asset, *problem, *optimum, recordings, input_matters);
  judge_admissibility(fit.report, options.admissibility);
  // What the recording says of the seal where the model does not come near it.
  for (const TimeSeries& recorded : recordings)
    if (const auto leakage = fit.report.admissible ? std::nullopt : closed_valve_leakage(asset, recorded))
      fit.report.reasons.push_back(in_words(*leakage));
  return fit;
}

}  // namespace sealwatch

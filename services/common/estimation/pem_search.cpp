#include "services/common/estimation/pem_search.hpp"

#include <ceres/ceres.h>
#include <glog/logging.h>

#include <algorithm>
#include <limits>
#include <mutex>

#include "services/common/estimation/box_search.hpp"

namespace sealwatch {
namespace {

ceres::Solver::Options solver_options(const ActuatorFitOptions& options) {
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_QR;
  solver.max_num_iterations = options.maximum_iterations;
  solver.function_tolerance = 0.0;     // CostResolved decides
  solver.parameter_tolerance = 1e-12;  // unknowns are of the order of one
  solver.logging_type = ceres::SILENT;
  return solver;
}

// Ends the search when an iteration changes the cost, or a rejected one promised to change it, by no more than the
// tolerance; gives it up when it is hopeless, and when its time is up.
class CostResolved final : public ceres::IterationCallback {
 public:
  explicit CostResolved(const StoppingRule& rule) : rule_(rule) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& iteration) override {
    if (passed(rule_.deadline)) return ceres::SOLVER_ABORT;
    // A step to where nothing can be simulated says nothing of the cost: Ceres tries a shorter one.
    const bool simulated = iteration.step_is_valid && iteration.cost_change > -std::numeric_limits<double>::max() / 2.0;
    if (iteration.iteration == 0 || !simulated) return ceres::SOLVER_CONTINUE;
    if (iteration.step_is_successful && rule_.is_hopeless(iteration.cost, ++successful_)) return ceres::SOLVER_ABORT;
    const double promised = iteration.cost_change / iteration.relative_decrease;  // by the linear model
    // Of a rejected step Ceres tells the cost there, not the one that stands.
    const double stands = iteration.step_is_successful ? iteration.cost : iteration.cost + iteration.cost_change;
    const double tolerance = rule_.at_cost(stands);
    const bool resolved = std::abs(iteration.cost_change) <= tolerance || (promised >= 0.0 && promised <= tolerance);
    return resolved ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

 private:
  const StoppingRule& rule_;
  int successful_ = 0;
};

// Ceres reports steps into parameter regions that cannot be simulated as warnings; they are ordinary rejected steps
// here. Once: searches run side by side.
void silence_ceres() {
  static std::once_flag once;
  std::call_once(once, [] { FLAGS_minloglevel = google::GLOG_FATAL; });
}

}  // namespace

PemPoint start_point(const PemProblem& problem, double factor) {
  PemPoint point;
  for (const Unknown& unknown : problem.shared)
    point.shared.push_back(
        unknown.to_unknown(unknown.logarithmic && !unknown.is_known() ? unknown.start * factor : unknown.start));
  for (const PemRecording& recording : problem.recordings) {
    std::vector<double>& own = point.own.emplace_back();
    for (const Unknown& unknown : recording.own) own.push_back(unknown.to_unknown(unknown.start));
  }
  return point;
}

namespace {

// A plant without states whose parameters are all fixed leaves nothing to search for.
Result<PemOptimum> as_it_is(const PemProblem& problem, PemPoint point) {
  PemOptimum optimum{.point = std::move(point), .at_optimum = {}, .termination = "nothing is free"};
  optimum.converged = true;
  for (std::size_t k = 0; k < problem.recordings.size(); ++k) {
    Result<Linearisation> at = linearise(problem, k, optimum.point.shared, optimum.point.own[k]);
    if (!at) return fail(at.error());
    optimum.cost += 0.5 * at->residual.squaredNorm();
    optimum.at_optimum.push_back(std::move(*at));
  }
  return optimum;
}

// Ceres' own bounds shorten every step that would cross one: slow, but what it needs where steps on the normal equations
// come no further.
void set_ranges(ceres::Problem& problem, const std::vector<Unknown>& unknowns, PemPoint& point) {
  for (std::size_t k = 0; k < unknowns.size(); ++k) {
    const Unknown& unknown = unknowns[k];
    if (!(unknown.max > unknown.min)) continue;
    problem.SetParameterLowerBound(point.shared.data(), static_cast<int>(k), unknown.to_unknown(unknown.min));
    problem.SetParameterUpperBound(point.shared.data(), static_cast<int>(k), unknown.to_unknown(unknown.max));
  }
}

StoppingRule stopping_rule(const PemProblem& problem, const ActuatorFitOptions& options) {
  double residuals = 0.0;
  for (const PemRecording& recording : problem.recordings)
    residuals += static_cast<double>(recording.simulation->recorded().size());
  return {.tolerance = options.cost_tolerance * static_cast<double>(problem.recordings.size()),
          .noise_cost = 0.5 * residuals,
          .hopeless_cost = 0.5 * residuals * options.hopeless_rms * options.hopeless_rms,
          .deadline = problem.simulation_options.deadline};
}

// From where the search in the box came no further.
SearchEnd search_on(ceres::Problem& ceres_problem, const StoppingRule& rule, const ActuatorFitOptions& options,
                    const PemProblem& problem, PemOptimum& optimum) {
  set_ranges(ceres_problem, problem.shared, optimum.point);
  CostResolved resolved(rule);
  ceres::Solver::Options solver = solver_options(options);
  solver.callbacks.push_back(&resolved);
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &ceres_problem, &summary);
  optimum.iterations += static_cast<int>(summary.iterations.size());
  optimum.cost = summary.final_cost;
  if (passed(rule.deadline)) return SearchEnd::out_of_time;
  switch (summary.termination_type) {
    case ceres::USER_SUCCESS:
    case ceres::CONVERGENCE:
      return SearchEnd::converged;
    case ceres::USER_FAILURE:
      return SearchEnd::hopeless;
    case ceres::NO_CONVERGENCE:
      return SearchEnd::out_of_iterations;
    default:
      return SearchEnd::stuck;
  }
}

std::string in_words(SearchEnd end) {
  switch (end) {
    case SearchEnd::converged:
      return "converged: the last step changed the cost by less than its tolerance";
    case SearchEnd::hopeless:
      return "given up: the model does not come near the recording";
    case SearchEnd::out_of_iterations:
      return "not converged: out of iterations";
    case SearchEnd::out_of_reach:
      return "not converged: a better fit is known to exist";
    case SearchEnd::out_of_time:
      return "not converged: out of time";
    case SearchEnd::stuck:
      break;
  }
  return "not converged: no step from there can be simulated or comes nearer";
}

}  // namespace

Result<PemOptimum> search(const PemProblem& problem, PemPoint start, const ActuatorFitOptions& options,
                          KnownBefore known) {
  silence_ceres();
  if (problem.shared.empty() && start.own.front().empty()) return as_it_is(problem, std::move(start));
  PemOptimum optimum{.point = std::move(start), .at_optimum = {}, .termination = {}};
  SideBySide side_by_side(optimum.point, options.threads);
  ceres::Problem::Options problem_options;
  problem_options.evaluation_callback = &side_by_side;
  ceres::Problem ceres_problem(problem_options);
  std::vector<RecordingCost*> costs;
  for (std::size_t k = 0; k < problem.recordings.size(); ++k) {
    costs.push_back(new RecordingCost(problem, k, side_by_side.failed()));  // owned by ceres_problem
    side_by_side.add(costs.back());
    if (k < known.at_start.size())
      costs.back()->remember(optimum.point.shared, optimum.point.own[k], std::move(known.at_start[k]));
    if (k < known.kept.size()) costs.back()->keep(std::move(known.kept[k]));
    std::vector<double*> blocks;
    if (!problem.shared.empty()) blocks.push_back(optimum.point.shared.data());
    if (!optimum.point.own[k].empty()) blocks.push_back(optimum.point.own[k].data());
    ceres_problem.AddResidualBlock(costs.back(), nullptr, blocks);
  }
  if (std::ranges::any_of(problem.shared, &Unknown::is_known))
    ceres_problem.AddResidualBlock(new PriorCost(problem.shared), nullptr, optimum.point.shared.data());

  StoppingRule rule = stopping_rule(problem, options);
  rule.bound = known.bound;
  if (options.progress)
    rule.on_iteration = [&](int iterations) {
      const double share = std::min(1.0, static_cast<double>(iterations) / options.maximum_iterations);
      options.progress("iteration " + std::to_string(iterations) + " (usually 5 to 8)", share);
    };
  BoxSearch in_box(problem, optimum.point, side_by_side);
  SearchEnd end = in_box.run(rule, options.maximum_iterations);
  optimum.iterations = in_box.iterations();
  optimum.cost = in_box.cost();
  optimum.promised = end == SearchEnd::stuck ? std::numeric_limits<double>::infinity() : in_box.promised();
  if (end == SearchEnd::stuck) end = search_on(ceres_problem, rule, options, problem, optimum);
  optimum.converged = end == SearchEnd::converged;
  optimum.hopeless = end == SearchEnd::hopeless;
  optimum.out_of_reach = end == SearchEnd::out_of_reach;
  optimum.termination = in_words(end);
  for (std::size_t k = 0; k < costs.size(); ++k) {
    Result<Linearisation> linearisation = costs[k]->take_linearisation(optimum.point.shared, optimum.point.own[k]);
    if (!linearisation) return fail(linearisation.error());
    optimum.at_optimum.push_back(std::move(*linearisation));
  }
  return optimum;
}

}  // namespace sealwatch

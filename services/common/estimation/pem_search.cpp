#include "services/common/estimation/pem_search.hpp"

#include <ceres/ceres.h>
#include <glog/logging.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <future>
#include <limits>
#include <mutex>
#include <optional>

#include "services/common/estimation/minimum_in_box.hpp"

namespace sealwatch {
namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// One recording as one residual block of as many rows as it has unknowns, plus one (compress() in pem_problem.hpp):
// Ceres sees the same cost, gradient and Gauss-Newton matrix as with all samples.
class RecordingCost final : public ceres::CostFunction {
 public:
  /// `failed`: some recording cannot be simulated at the point that is asked.
  RecordingCost(const PemProblem& problem, std::size_t recording, const std::atomic<bool>& failed)
      : problem_(problem), recording_(recording), point_failed_(failed) {
    shared_.resize(problem.shared.size());
    own_.resize(problem.recordings[recording].own.size());
    set_num_residuals(static_cast<int>(shared_.size() + own_.size()) + 1);
    if (!shared_.empty()) mutable_parameter_block_sizes()->push_back(static_cast<int>(shared_.size()));
    if (!own_.empty()) mutable_parameter_block_sizes()->push_back(static_cast<int>(own_.size()));
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    if (point_failed_ || !update(shared_.empty() ? nullptr : parameters[0],
                                 own_.empty() ? nullptr : parameters[shared_.empty() ? 0 : 1]))
      return false;
    const auto n = static_cast<Eigen::Index>(shared_.size() + own_.size());
    Eigen::Map<Eigen::VectorXd>(residuals, n + 1) = compressed_.col(n);
    if (jacobians == nullptr) return true;
    const auto shared = static_cast<Eigen::Index>(shared_.size()), own = static_cast<Eigen::Index>(own_.size());
    std::size_t block = 0;
    if (shared > 0 && jacobians[block++] != nullptr)
      Eigen::Map<Matrix>(jacobians[0], n + 1, shared) = compressed_.leftCols(shared);
    if (own > 0 && jacobians[block] != nullptr)
      Eigen::Map<Matrix>(jacobians[block], n + 1, own) = compressed_.middleCols(shared, own);
    return true;
  }

  /// The cost's derivative by the shared unknowns, at the point that was evaluated last.
  [[nodiscard]] Eigen::VectorXd gradient() const {
    const auto n = static_cast<Eigen::Index>(shared_.size());
    return compressed_.leftCols(n).transpose() * compressed_.col(compressed_.cols() - 1);
  }

  /// d residual / d (shared, own), residual: as many rows as columns.
  [[nodiscard]] const Eigen::MatrixXd& compressed() const { return compressed_; }

  void remember(const std::vector<double>& shared, const std::vector<double>& own, Linearisation linearisation) {
    shared_ = shared;
    own_ = own;
    linearisation_ = std::move(linearisation);
    compressed_ = compress(linearisation_);
    known_ = true;
  }

  /// At the given point, which usually is the one that was evaluated last.
  [[nodiscard]] Result<Linearisation> take_linearisation(const std::vector<double>& shared,
                                                         const std::vector<double>& own) const {
    if (!known_ || shared != shared_ || own != own_) return linearise(problem_, recording_, shared, own);
    known_ = false;
    return std::move(linearisation_);
  }

  /// Ceres asks several times for the same point, first for the cost, then for its derivatives: both cost one
  /// simulation. False where nothing can be simulated.
  bool update(const double* shared, const double* own) const {
    const bool same = std::equal(shared_.begin(), shared_.end(), shared) && std::equal(own_.begin(), own_.end(), own);
    if (same && known_) return true;
    std::copy_n(shared, shared_.size(), shared_.begin());
    std::copy_n(own, own_.size(), own_.begin());
    Result<Linearisation> result = linearise(problem_, recording_, shared_, own_);
    known_ = result.has_value();
    if (!known_) return false;
    linearisation_ = std::move(*result);
    compressed_ = compress(linearisation_);
    return true;
  }

 private:
  const PemProblem& problem_;
  std::size_t recording_;
  const std::atomic<bool>& point_failed_;
  mutable std::vector<double> shared_, own_;
  mutable Linearisation linearisation_;
  mutable Eigen::MatrixXd compressed_;
  mutable bool known_ = false;  ///< at that point
};

// What is known of the shared unknowns beforehand, one residual each.
class PriorCost final : public ceres::CostFunction {
 public:
  explicit PriorCost(const std::vector<Unknown>& unknowns) : unknowns_(unknowns) {
    set_num_residuals(static_cast<int>(std::ranges::count_if(unknowns, &Unknown::is_known)));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(unknowns.size()));
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    Eigen::Index row = 0;
    const auto columns = static_cast<Eigen::Index>(unknowns_.size());
    double* jacobian = jacobians == nullptr ? nullptr : jacobians[0];
    if (jacobian != nullptr) Eigen::Map<Matrix>(jacobian, num_residuals(), columns).setZero();
    for (Eigen::Index k = 0; k < columns; ++k) {
      const Unknown& unknown = unknowns_[static_cast<std::size_t>(k)];
      if (!unknown.is_known()) continue;
      residuals[row] = unknown.prior_residual(parameters[0][k]);
      if (jacobian != nullptr) jacobian[row * columns + k] = -1.0 / unknown.prior_std;
      ++row;
    }
    return true;
  }

 private:
  const std::vector<Unknown>& unknowns_;
};

// Recordings are simulated side by side before Ceres asks for any of them. Ceres itself runs in one thread: in several
// it adds them up in the order in which they come, and the digits would depend on the number of threads. Where one
// cannot be simulated the point is given up: failing costs the integrator most.
class SideBySide final : public ceres::EvaluationCallback {
 public:
  SideBySide(const PemPoint& point, int threads) : point_(point), threads_(static_cast<std::size_t>(threads)) {}
  void add(const RecordingCost* cost) { costs_.push_back(cost); }
  [[nodiscard]] const std::atomic<bool>& failed() const { return failed_; }

  void PrepareForEvaluation(bool /*evaluate_jacobians*/, bool new_evaluation_point) override {
    if (!new_evaluation_point) return;
    failed_ = false;
    std::vector<std::future<void>> running;
    for (std::size_t first = 1; first < std::min(threads_, costs_.size()); ++first)
      running.push_back(std::async(std::launch::async, [this, first] { update_from(first); }));
    update_from(0);
    for (std::future<void>& one : running) one.get();
  }

 private:
  void update_from(std::size_t first) {
    for (std::size_t k = first; k < costs_.size() && !failed_; k += threads_)
      if (!costs_[k]->update(point_.shared.data(), point_.own[k].data())) failed_ = true;
  }

  const PemPoint& point_;
  std::size_t threads_;
  std::vector<const RecordingCost*> costs_;
  std::atomic<bool> failed_ = false;
};

// The unknowns that are held at an end of their range, and the others free: an active set. Ceres' own bounds shorten
// every step that would cross one, which costs dozens of iterations here. Instead the search is free, and what ends
// outside is held in the next round: a first step may overshoot and come back. What is known beforehand moves little,
// and almost linearly: it is held as soon as it leaves, and what comes inside again is let go in the end.
class ActiveSet {
 public:
  ActiveSet(const std::vector<Unknown>& unknowns, std::vector<double>& values)
      : unknowns_(unknowns), values_(values), held_(unknowns.size(), false) {}

  [[nodiscard]] bool a_known_one_left() const {
    for (std::size_t k = 0; k < values_.size(); ++k)
      if (unknowns_[k].is_known() && inside(k) != values_[k]) return true;
    return false;
  }

  [[nodiscard]] bool holds(Eigen::Index k) const { return held_[static_cast<std::size_t>(k)]; }
  [[nodiscard]] bool holds_any() const { return std::ranges::find(held_, true) != held_.end(); }

  /// Unknowns that left their range, or of these only what is known, are moved to its end and held there. True when
  /// there were any.
  bool hold(bool known_only) {
    bool any = false;
    for (std::size_t k = 0; k < values_.size(); ++k) {
      if (inside(k) == values_[k] || (known_only && !unknowns_[k].is_known())) continue;
      values_[k] = inside(k);
      held_[k] = any = true;
    }
    return any;
  }

  /// Lets go of those that would come back inside, and lower the cost by more than `tolerance` were it linear through
  /// their range. True when there were any.
  bool let_go(const Eigen::VectorXd& gradient, double tolerance) {
    bool any = false;
    for (std::size_t k = 0; k < values_.size(); ++k) {
      const Unknown& unknown = unknowns_[k];
      const double slope = gradient(static_cast<Eigen::Index>(k)), lower = unknown.to_unknown(unknown.min);
      const bool inwards = values_[k] <= lower ? slope < 0.0 : slope > 0.0;
      const double promised = std::abs(slope) * (unknown.to_unknown(unknown.max) - lower);
      if (!held_[k] || !inwards || promised <= tolerance) continue;
      held_[k] = false;
      any = true;
    }
    return any;
  }

  void apply(ceres::Problem& problem) {
    if (values_.empty()) return;
    std::vector<int> held;
    for (std::size_t k = 0; k < held_.size(); ++k)
      if (held_[k]) held.push_back(static_cast<int>(k));
    const bool all = held.size() == held_.size();
    all ? problem.SetParameterBlockConstant(values_.data()) : problem.SetParameterBlockVariable(values_.data());
    const bool some = !held.empty() && !all;
    problem.SetManifold(values_.data(),
                        some ? new ceres::SubsetManifold(static_cast<int>(held_.size()), held) : nullptr);
  }

 private:
  [[nodiscard]] double inside(std::size_t k) const {
    const Unknown& unknown = unknowns_[k];
    if (!(unknown.max > unknown.min)) return values_[k];
    return std::clamp(values_[k], unknown.to_unknown(unknown.min), unknown.to_unknown(unknown.max));
  }

  const std::vector<Unknown>& unknowns_;
  std::vector<double>& values_;
  std::vector<bool> held_;
};

ceres::Solver::Options solver_options(const ActuatorFitOptions& options) {
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_QR;
  solver.max_num_iterations = options.maximum_iterations;
  solver.function_tolerance = 0.0;     // CostResolved decides
  solver.parameter_tolerance = 1e-12;  // unknowns are of the order of one
  solver.logging_type = ceres::SILENT;
  solver.update_state_every_iteration = true;  // the active set looks at it
  return solver;
}

// Ends the search when an iteration changes the cost, or a rejected one promised to change it, by no more than
// `tolerance`; gives it up when after several iterations the cost is still above `hopeless_cost`. Where the misfit is
// above the noise, standard errors grow with it and so does the tolerance: cost / noise_cost is the misfit's mean
// square. Ends it, too, when its time is up.
class CostResolved final : public ceres::IterationCallback {
 public:
  CostResolved(double tolerance, double noise_cost, double hopeless_cost, const Deadline* deadline)
      : tolerance_(tolerance), noise_cost_(noise_cost), hopeless_cost_(hopeless_cost), deadline_(deadline) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& iteration) override {
    if (passed(deadline_)) return ceres::SOLVER_ABORT;
    // A step to where nothing can be simulated says nothing of the cost: Ceres tries a shorter one.
    const bool simulated = iteration.step_is_valid && iteration.cost_change > -std::numeric_limits<double>::max() / 2.0;
    if (iteration.iteration == 0 || !simulated) return ceres::SOLVER_CONTINUE;
    if (iteration.step_is_successful && is_hopeless(iteration.cost, ++successful_)) return ceres::SOLVER_ABORT;
    const double promised = iteration.cost_change / iteration.relative_decrease;  // by the linear model
    const double tolerance = at_cost(iteration.cost);
    const bool resolved = std::abs(iteration.cost_change) <= tolerance || (promised >= 0.0 && promised <= tolerance);
    return resolved ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

  [[nodiscard]] bool is_hopeless(double cost, int iterations) const {
    return iterations >= kIterationsForHope && cost > hopeless_cost_;
  }
  /// What counts as no change of this cost.
  [[nodiscard]] double at_cost(double cost) const { return tolerance_ * std::max(1.0, cost / noise_cost_); }

 private:
  static constexpr int kIterationsForHope = 6;  // fits that come to something are there by then
  double tolerance_, noise_cost_, hopeless_cost_;
  const Deadline* deadline_;
  int successful_ = 0;
};

// Ends a round of the search once a value is further off than what is known of it.
class RangeLeft final : public ceres::IterationCallback {
 public:
  explicit RangeLeft(const ActiveSet& active) : active_(active) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& /*iteration*/) override {
    return active_.a_known_one_left() ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

 private:
  const ActiveSet& active_;
};

// Ceres reports steps into parameter regions that cannot be simulated as warnings; they are ordinary rejected steps
// here. Once: searches run side by side.
void silence_ceres() {
  static std::once_flag once;
  std::call_once(once, [] { FLAGS_minloglevel = google::GLOG_FATAL; });
}

// Gauss-Newton's steps. Near an optimum the residuals are nearly linear in the unknowns, and what is nonlinear is which
// of the values that are known beforehand end at an end of their range: minimum_in_box() finds that without a simulation.
// The others are free here (a strength that overshoots its end comes back), but for those that are held.
class NearSearch {
 public:
  NearSearch(const PemProblem& problem, PemPoint& point, const std::vector<RecordingCost*>& costs, SideBySide& all,
             const ActiveSet& active)
      : problem_(problem), point_(point), costs_(costs), all_(all), active_(active) {
    size_ = static_cast<Eigen::Index>(point.shared.size());
    for (const std::vector<double>& own : point.own) size_ += static_cast<Eigen::Index>(own.size());
  }

  enum class End { converged, too_far, out_of_iterations, hopeless, out_of_time };
  /// Ends `too_far` at the last point from which the linear model still kept what it promised.
  End run(const CostResolved& resolved, int maximum_iterations, const Deadline* deadline);

  [[nodiscard]] int iterations() const { return iterations_; }
  [[nodiscard]] double cost() const { return cost_; }

 private:
  static constexpr double kKept = 0.5;  // of what the linear model promises
  // Far from the optimum a shape that is hardly seen yet must not run to the end of its range: Ceres' own first damping,
  // and how it falls.
  static constexpr double kDamping = 1e-4, kFalls = 1.0 / 3.0, kUndamped = 1e-8;

  /// The linear model at the point.
  struct Model {
    Eigen::MatrixXd gram;
    Eigen::VectorXd gradient, low, high;
    [[nodiscard]] Eigen::VectorXd step(double damping) const {
      return minimum_in_box(gram, gradient, low, high, damping);
    }
    /// Fall of the cost.
    [[nodiscard]] double promised(const Eigen::VectorXd& by) const { return -by.dot(gradient + 0.5 * gram * by); }
  };

  /// At the point; infinite where a recording cannot be simulated.
  [[nodiscard]] double evaluate() {
    ++iterations_;
    all_.PrepareForEvaluation(true, true);
    if (all_.failed()) return std::numeric_limits<double>::infinity();
    double sum = 0.0;
    for (const RecordingCost* cost : costs_) sum += 0.5 * cost->compressed().rightCols(1).squaredNorm();
    for (std::size_t k = 0; k < point_.shared.size(); ++k)
      if (problem_.shared[k].is_known()) sum += 0.5 * std::pow(problem_.shared[k].prior_residual(point_.shared[k]), 2);
    return sum;
  }

  [[nodiscard]] Model model() const {
    constexpr double kInfinite = std::numeric_limits<double>::infinity();
    Model here{.gram = Eigen::MatrixXd::Zero(size_, size_),
               .gradient = Eigen::VectorXd::Zero(size_),
               .low = Eigen::VectorXd::Constant(size_, -kInfinite),
               .high = Eigen::VectorXd::Constant(size_, kInfinite)};
    const auto shared = static_cast<Eigen::Index>(point_.shared.size());
    Eigen::Index first_own = shared;
    for (const RecordingCost* cost : costs_) {
      const Eigen::MatrixXd& all = cost->compressed();
      const Eigen::Index n = all.cols() - 1;
      std::vector<Eigen::Index> place(static_cast<std::size_t>(n));
      for (Eigen::Index k = 0; k < n; ++k) place[static_cast<std::size_t>(k)] = k < shared ? k : first_own + k - shared;
      here.gram(place, place) += all.leftCols(n).transpose() * all.leftCols(n);
      here.gradient(place) += all.leftCols(n).transpose() * all.col(n);
      first_own += n - shared;
    }
    for (Eigen::Index k = 0; k < shared; ++k) {
      const Unknown& unknown = problem_.shared[static_cast<std::size_t>(k)];
      const double at = point_.shared[static_cast<std::size_t>(k)];
      if (unknown.is_known()) {
        here.gram(k, k) += 1.0 / (unknown.prior_std * unknown.prior_std);
        here.gradient(k) -= unknown.prior_residual(at) / unknown.prior_std;
      }
      if (active_.holds(k)) here.low(k) = here.high(k) = 0.0;
      if (active_.holds(k) || !unknown.is_known() || !(unknown.max > unknown.min)) continue;
      here.low(k) = unknown.to_unknown(unknown.min) - at;
      here.high(k) = unknown.to_unknown(unknown.max) - at;
    }
    return here;
  }

  void move(const Eigen::VectorXd& by) {
    Eigen::Index k = 0;
    for (std::size_t j = 0; j < point_.shared.size(); ++j) {
      const Unknown& unknown = problem_.shared[j];
      point_.shared[j] += by(k++);
      if (unknown.is_known() && unknown.max > unknown.min)  // rounding
        point_.shared[j] =
            std::clamp(point_.shared[j], unknown.to_unknown(unknown.min), unknown.to_unknown(unknown.max));
    }
    for (std::vector<double>& own : point_.own)
      for (double& value : own) value += by(k++);
  }

  const PemProblem& problem_;
  PemPoint& point_;
  const std::vector<RecordingCost*>& costs_;
  SideBySide& all_;
  const ActiveSet& active_;
  Eigen::Index size_ = 0;
  int iterations_ = 0;
  double cost_ = 0.0;
};

NearSearch::End NearSearch::run(const CostResolved& resolved, int maximum_iterations, const Deadline* deadline) {
  const int end = iterations_ + maximum_iterations;
  cost_ = evaluate();
  if (!std::isfinite(cost_)) return End::too_far;
  double damping = kDamping;
  while (iterations_ <= end) {
    if (passed(deadline)) return End::out_of_time;
    if (resolved.is_hopeless(cost_, iterations_)) return End::hopeless;
    const Model here = model();
    const double tolerance = resolved.at_cost(cost_);
    Eigen::VectorXd by = here.step(kUndamped);
    if (!by.allFinite()) return End::too_far;
    if (here.promised(by) <= tolerance) return End::converged;
    if (const Eigen::VectorXd damped = here.step(damping); here.promised(damped) > tolerance) by = damped;
    damping = std::max(kUndamped, kFalls * damping);
    const PemPoint before = point_;
    const double promised = here.promised(by);
    move(by);
    const double after = evaluate(), change = cost_ - after;
    if (!(change >= kKept * promised)) {
      point_ = before;
      return End::too_far;
    }
    cost_ = after;
    if (change <= tolerance) return End::converged;
  }
  return End::out_of_iterations;
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

// The cost's derivative by the shared unknowns; nothing where a recording cannot be simulated.
std::optional<Eigen::VectorXd> gradient_at(const PemPoint& point, const PemProblem& problem,
                                           const std::vector<RecordingCost*>& costs) {
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(point.shared.size()));
  for (std::size_t k = 0; k < costs.size(); ++k) {
    if (!costs[k]->update(point.shared.data(), point.own[k].data())) return std::nullopt;
    gradient += costs[k]->gradient();
  }
  for (std::size_t k = 0; k < point.shared.size(); ++k)
    if (const Unknown& unknown = problem.shared[k]; unknown.is_known())
      gradient(static_cast<Eigen::Index>(k)) -= unknown.prior_residual(point.shared[k]) / unknown.prior_std;
  return gradient;
}

// Near searches until nothing is outside its range, and nothing held would come back inside. Iterations are renewed where
// something is held; once some were let go, the search ends.
NearSearch::End search_near(NearSearch& near, ActiveSet& active, const CostResolved& resolved, int maximum_iterations,
                            const PemProblem& problem, const PemPoint& point,
                            const std::vector<RecordingCost*>& costs) {
  using End = NearSearch::End;
  const Deadline* deadline = problem.simulation_options.deadline;
  End end = near.run(resolved, maximum_iterations, deadline);
  bool let_go_of_some = false;
  while (end == End::converged || end == End::out_of_iterations) {
    if (!active.hold(false)) {
      if (end == End::out_of_iterations || let_go_of_some || !active.holds_any()) break;
      const auto gradient = gradient_at(point, problem, costs);
      if (!gradient || !active.let_go(*gradient, resolved.at_cost(near.cost()))) break;
      let_go_of_some = true;
    }
    end = near.run(resolved, maximum_iterations, deadline);
  }
  return end;
}

}  // namespace

Result<PemOptimum> search(const PemProblem& problem, PemPoint start, const ActuatorFitOptions& options,
                          std::vector<Linearisation> at_start) {
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
    if (k < at_start.size()) costs.back()->remember(optimum.point.shared, optimum.point.own[k], std::move(at_start[k]));
    std::vector<double*> blocks;
    if (!problem.shared.empty()) blocks.push_back(optimum.point.shared.data());
    if (!optimum.point.own[k].empty()) blocks.push_back(optimum.point.own[k].data());
    ceres_problem.AddResidualBlock(costs.back(), nullptr, blocks);
  }
  if (std::ranges::any_of(problem.shared, &Unknown::is_known))
    ceres_problem.AddResidualBlock(new PriorCost(problem.shared), nullptr, optimum.point.shared.data());
  double residuals = 0.0;
  for (const PemRecording& recording : problem.recordings)
    residuals += static_cast<double>(recording.simulation->recorded().size());
  CostResolved resolved(options.cost_tolerance * static_cast<double>(problem.recordings.size()), 0.5 * residuals,
                        0.5 * residuals * options.hopeless_rms * options.hopeless_rms,
                        problem.simulation_options.deadline);
  ceres::Solver::Options solver = solver_options(options);
  solver.callbacks.push_back(&resolved);
  ceres::Solver::Summary summary;
  ActiveSet active(problem.shared, optimum.point.shared);
  RangeLeft range_left(active);
  solver.callbacks.push_back(&range_left);
  NearSearch near(problem, optimum.point, costs, side_by_side, active);
  const NearSearch::End end =
      search_near(near, active, resolved, options.maximum_iterations, problem, optimum.point, costs);
  optimum.iterations = near.iterations();
  optimum.converged = end == NearSearch::End::converged;
  optimum.hopeless = end == NearSearch::End::hopeless;
  summary.final_cost = near.cost();
  solver.max_num_iterations -= std::min(near.iterations(), options.maximum_iterations) - 1;
  bool again = end == NearSearch::End::too_far && solver.max_num_iterations > 0;
  bool let_go_of_some = false;  // once some were, iterations are not renewed: the search ends
  while (again) {
    active.apply(ceres_problem);
    ceres::Solve(solver, &ceres_problem, &summary);
    const auto iterations = static_cast<int>(summary.iterations.size());
    optimum.iterations += iterations;
    solver.max_num_iterations -= std::max(1, iterations - 1);
    const bool known_left = active.hold(true), others_left = !known_left && active.hold(false);
    optimum.converged =
        !known_left && !others_left &&
        (summary.termination_type == ceres::USER_SUCCESS || summary.termination_type == ceres::CONVERGENCE);
    if (others_left && !let_go_of_some) solver.max_num_iterations = options.maximum_iterations;
    again = known_left || others_left;
    if (optimum.converged && active.holds_any() && solver.max_num_iterations > 0) {
      const auto gradient = gradient_at(optimum.point, problem, costs);
      again = gradient && active.let_go(*gradient, resolved.at_cost(summary.final_cost));
      let_go_of_some = let_go_of_some || again;
    }
    again = again && solver.max_num_iterations > 0 && summary.termination_type != ceres::FAILURE;
  }
  const bool within_tolerance =
      optimum.converged && (end == NearSearch::End::converged || summary.termination_type == ceres::USER_SUCCESS);
  optimum.cost = summary.final_cost;
  optimum.hopeless = optimum.hopeless || summary.termination_type == ceres::USER_FAILURE;
  optimum.termination = within_tolerance   ? "converged: the last step changed the cost by less than its tolerance"
                        : optimum.hopeless ? "given up: the model does not come near the recording"
                        : end == NearSearch::End::out_of_iterations ? "not converged: out of iterations"
                        : end == NearSearch::End::out_of_time       ? "not converged: out of time"
                                                                    : summary.message;
  for (std::size_t k = 0; k < costs.size(); ++k) {
    Result<Linearisation> linearisation = costs[k]->take_linearisation(optimum.point.shared, optimum.point.own[k]);
    if (!linearisation) return fail(linearisation.error());
    optimum.at_optimum.push_back(std::move(*linearisation));
  }
  return optimum;
}

}  // namespace sealwatch

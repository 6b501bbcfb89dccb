// Gauss-Newton within ranges and within a box of trust: what of a step ends at an end of its range, or of that box, is
// solved exactly on the linear model, without a simulation.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "sealwatch/core/deadline.hpp"
#include "services/common/estimation/pem_costs.hpp"

namespace sealwatch {

/// When a search is over. Where the misfit is above the noise, standard errors grow with it, and so does what counts as
/// no change: cost / noise_cost is the misfit's mean square.
struct StoppingRule {
  double tolerance = 0.0;      ///< change of the cost that does not count, at the noise
  double noise_cost = 1.0;     ///< half the number of residuals
  double hopeless_cost = 0.0;  ///< above it after some iterations, a fit comes to nothing
  const Deadline* deadline = nullptr;
  SearchBound bound = {};
  std::function<void(int iterations)> on_iteration = {};

  [[nodiscard]] double at_cost(double cost) const { return tolerance * std::max(1.0, cost / noise_cost); }
  /// Kept derivatives err by what they miss times the residuals: only small residuals bear them.
  [[nodiscard]] bool is_near_noise(double cost) const {
    constexpr double kNear = 2.0;  // of its mean square
    return cost <= kNear * noise_cost;
  }
  [[nodiscard]] bool is_hopeless(double cost, int iterations) const {
    constexpr int kIterationsForHope = 6;  // fits that come to something are there by then
    return iterations >= kIterationsForHope && cost > hopeless_cost;
  }
};

enum class SearchEnd { converged, stuck, out_of_iterations, out_of_reach, hopeless, out_of_time };

/// A problem's search from a point, which it moves. What is known beforehand is kept in its range in each step. All
/// others are searched freely, since a strength that overshoots its end comes back, and are held where they end outside.
class BoxSearch {
 public:
  /// `costs`: of the problem's recordings, at `point`.
  BoxSearch(const PemProblem& problem, PemPoint& point, SideBySide& costs);

  /// `maximum_iterations` are renewed where something is held. Ends `stuck` where no shortened step keeps what the linear
  /// model promises, and the point is the best one.
  SearchEnd run(const StoppingRule& rule, int maximum_iterations);

  [[nodiscard]] int iterations() const { return iterations_; }
  [[nodiscard]] double cost() const { return cost_; }
  /// By how much the linear model at the point would let the cost fall.
  [[nodiscard]] double promised() const { return promised_; }

 private:
  /// Sum of squares, linear in the residuals, about the point.
  struct LinearModel;

  SearchEnd descend(const StoppingRule& rule, int maximum_iterations);
  /// By how much it promises to let the cost fall, and the cost there once it was taken.
  struct Step {
    Eigen::VectorXd by;
    double promised = 0.0;
    double after = std::numeric_limits<double>::infinity();
    [[nodiscard]] bool is_simulated() const { return std::isfinite(after); }
    /// A step that keeps less of its promise is taken back.
    [[nodiscard]] bool is_kept(double before) const {
      constexpr double kKept = 1e-3;
      return before - after >= kKept * promised;
    }
  };
  /// The point moves.
  [[nodiscard]] Step take(Step step, bool may_keep);
  /// In place of the step `v`, which was taken last and was too long.
  [[nodiscard]] Step bent(const LinearModel& here, const Eigen::VectorXd& v) const;
  /// At the point; infinite where a recording cannot be simulated. `may_keep`: derivatives by what is known beforehand.
  [[nodiscard]] double evaluate(bool may_keep = true);
  /// Of the point that was evaluated last, from where steps set out now.
  [[nodiscard]] LinearModel linear_model() const;
  /// Places of a recording's unknowns among all.
  [[nodiscard]] std::vector<Eigen::Index> places_of(std::size_t recording) const;
  void move(const Eigen::VectorXd& by);
  /// Unknowns outside their range are moved to its end and held there. True when there were any.
  bool hold_outside();
  /// Lets go of what is held and would come back inside, and lower the cost by more than `tolerance` were it linear
  /// through its range. True when there was any.
  bool let_go(double tolerance);

  const PemProblem& problem_;
  PemPoint& point_;
  SideBySide& costs_;
  std::vector<bool> held_;  ///< per shared unknown
  Eigen::Index size_ = 0;
  int iterations_ = 0;
  double cost_ = 0.0;
  double promised_ = 0.0;
};

}  // namespace sealwatch

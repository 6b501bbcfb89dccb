// The costs whose sum a search makes least: one of each recording, and one of what is known beforehand.
#pragma once

#include <ceres/cost_function.h>
#include <ceres/evaluation_callback.h>

#include <atomic>
#include <vector>

#include "services/common/estimation/pem_search.hpp"

namespace sealwatch {

/// What residuals after a step have beside the linear model where it set out: a = r(x + v) - r(x) - J v.
struct Bend {
  Eigen::VectorXd slope;       ///< J'a
  double with_residual = 0.0;  ///< r'a
  double square = 0.0;         ///< a'a
};

/// One recording as one residual block of as many rows as it has unknowns, plus one (compress() in pem_problem.hpp):
/// the same cost, gradient and Gauss-Newton matrix as with all samples.
class RecordingCost final : public ceres::CostFunction {
 public:
  /// `failed`: some recording cannot be simulated at the point that is asked.
  RecordingCost(const PemProblem& problem, std::size_t recording, const std::atomic<bool>& failed);

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

  /// d residual / d (shared, own), residual: as many rows as columns. Of the point that was evaluated last.
  [[nodiscard]] const Eigen::MatrixXd& compressed() const { return compressed_; }

  void remember(const std::vector<double>& shared, const std::vector<double>& own, Linearisation linearisation);

  /// Derivatives by what is known beforehand, from near the point where a search sets out.
  void keep(KeptDerivatives kept) { kept_ = std::move(kept); }

  /// At the given point, which usually is the one that was evaluated last.
  [[nodiscard]] Result<Linearisation> take_linearisation(const std::vector<double>& shared,
                                                         const std::vector<double>& own) const;

  /// Ceres asks several times for the same point, first for the cost, then for its derivatives: both cost one
  /// simulation. With `may_keep` derivatives by what is known beforehand are those of an earlier point, where there was
  /// one. False where nothing can be simulated.
  bool update(const double* shared, const double* own, bool may_keep = false) const;

  /// Steps set out from the point that was evaluated last: what is there is kept until the next such point.
  void set_out_from_here() const { sets_out_ = true; }
  /// Of the step from there to the point that was evaluated last.
  [[nodiscard]] Bend bend(const Eigen::VectorXd& step) const;

  /// Whether some derivatives are those of an earlier point.
  [[nodiscard]] bool has_kept() const { return linearisation_.has_kept; }

 private:
  const PemProblem& problem_;
  std::size_t recording_;
  const std::atomic<bool>& point_failed_;
  mutable std::vector<double> shared_, own_;
  mutable Linearisation linearisation_;  ///< by what is not known, where the rest is kept
  mutable Eigen::MatrixXd compressed_;
  mutable KeptDerivatives kept_;
  mutable Linearisation from_;     ///< where steps set out
  mutable bool sets_out_ = false;  ///< that is the point that was evaluated last
  mutable bool known_ = false;     ///< at that point
};

/// What is known of the shared unknowns beforehand, one residual each.
class PriorCost final : public ceres::CostFunction {
 public:
  explicit PriorCost(const std::vector<Unknown>& unknowns);
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  const std::vector<Unknown>& unknowns_;
};

/// Recordings are simulated side by side before any of them is asked for. Ceres itself runs in one thread: in several
/// it adds them up in the order in which they come, and the digits would depend on the number of threads. Where one
/// cannot be simulated the point is given up: failing costs the integrator most.
class SideBySide final : public ceres::EvaluationCallback {
 public:
  SideBySide(const PemPoint& point, int threads) : point_(point), threads_(threads) {}

  /// All recordings at the point, as RecordingCost::update() has it.
  void evaluate(bool may_keep);
  void add(const RecordingCost* cost) { costs_.push_back(cost); }
  [[nodiscard]] const std::vector<const RecordingCost*>& costs() const { return costs_; }
  [[nodiscard]] const std::atomic<bool>& failed() const { return failed_; }

  void PrepareForEvaluation(bool evaluate_jacobians, bool new_evaluation_point) override;

 private:
  const PemPoint& point_;
  int threads_;
  std::vector<const RecordingCost*> costs_;
  std::atomic<bool> failed_ = false;
};

}  // namespace sealwatch

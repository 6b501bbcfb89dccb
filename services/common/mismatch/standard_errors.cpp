#include "services/common/mismatch/standard_errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "services/common/dense/dense.hpp"
#include "services/common/dense/row_products.hpp"
#include "services/common/mismatch/criterion.hpp"
#include "services/common/mismatch/linear_algebra.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kBlock_s = 2.0;      // longer than the transients that a wrong form leaves at a corner of a test
constexpr double kLeastBlock = 10.0;  // samples, where they are further apart than a plant for which that is long

struct Normal {
  Eigen::MatrixXd information, scores;  ///< sum_i J_i' J_i, B
  int blocks = 0;
};

// `scores` of one recording, block by block.
void add_recording(const Linearisation& at, const std::vector<double>& time_s, Normal& normal) {
  const Eigen::Index shared = normal.information.cols();
  RowMatrix jacobian = at.jacobian.leftCols(shared);
  const RowMatrix own = at.jacobian.rightCols(at.jacobian.cols() - shared);
  Projection(own).remove_from(jacobian);
  normal.information += dense::gram_of_rows(jacobian);
  const double spacing_s = (time_s.back() - time_s.front()) / static_cast<double>(time_s.size() - 1);
  const auto samples = static_cast<Eigen::Index>(std::max(kLeastBlock, std::round(kBlock_s / spacing_s)));
  const Eigen::Index rows = samples * at.simulated.cols();
  for (Eigen::Index begin = 0; begin < jacobian.rows(); begin += rows) {
    const Eigen::Index count = std::min(rows, jacobian.rows() - begin);
    const Eigen::VectorXd score = jacobian.middleRows(begin, count).transpose() * at.residual.segment(begin, count);
    normal.scores.noalias() += score * score.transpose();
    ++normal.blocks;
  }
}

// What the data tell of: scaled to a unit diagonal, as the unknowns differ by twenty orders of magnitude.
std::vector<Eigen::Index> told_by_data(const FittedModel& model, const Eigen::MatrixXd& information) {
  std::vector<Eigen::Index> told;
  for (std::size_t k = 0; k < model.problem.shared.size(); ++k) {
    const auto j = static_cast<Eigen::Index>(k);
    if (information(j, j) > 0.0 && !at_bound(model.problem.shared[k], model.optimum.point.shared[k])) told.push_back(j);
  }
  return told;
}

Normal normal_of(const FittedModel& model) {
  const auto shared = static_cast<Eigen::Index>(model.problem.shared.size());
  Normal normal{.information = Eigen::MatrixXd::Zero(shared, shared), .scores = Eigen::MatrixXd::Zero(shared, shared)};
  for (std::size_t k = 0; k < model.optimum.at_optimum.size(); ++k) {
    std::optional<Linearisation> anew;
    if (const Linearisation& at = linearised(model, k, anew); at.jacobian.size() > 0)
      add_recording(at, model.problem.recordings[k].time_s, normal);
  }
  if (normal.blocks > 1) normal.scores *= normal.blocks / (normal.blocks - 1.0);
  return normal;
}

Eigen::MatrixXd known_beforehand(const FittedModel& model) {
  const auto shared = static_cast<Eigen::Index>(model.problem.shared.size());
  Eigen::MatrixXd prior = Eigen::MatrixXd::Zero(shared, shared);
  for (std::size_t k = 0; k < model.problem.shared.size(); ++k)
    if (const Unknown& unknown = model.problem.shared[k]; unknown.is_known())
      prior(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(k)) = 1.0 / std::pow(unknown.prior_std, 2);
  return prior;
}

// Both variances above, of the unknowns that the data tell of.
class Covariance {
 public:
  explicit Covariance(const FittedModel& model) {
    const Normal normal = normal_of(model);
    const Eigen::MatrixXd prior = known_beforehand(model);
    const double phi = dispersion(model);
    const Eigen::MatrixXd information = normal.information / phi + prior;
    told_ = told_by_data(model, information);
    scale_ = subvector(information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse(), told_);
    const auto scaled = [&](const Eigen::MatrixXd& matrix) -> Eigen::MatrixXd {
      return dense::scaled(submatrix(matrix, told_), scale_);
    };
    Eigen::MatrixXd a = scaled(information);
    a.diagonal().array() += 1e-12;
    inverse_ = dense::inverse(a);
    by_scores_ = dense::product(dense::product(inverse_, scaled(normal.scores / (phi * phi) + prior)), inverse_);
  }

  /// Of a shared unknown; infinite where the data cannot tell.
  [[nodiscard]] double standard_error(std::size_t k) const {
    const auto at = place(k);
    if (!at) return std::numeric_limits<double>::infinity();
    return std::sqrt(std::max(inverse_(*at, *at), by_scores_(*at, *at))) * scale_(*at);
  }
  /// Of one that `others` are given beside; those that the data do not tell of are given anyhow.
  [[nodiscard]] double standard_error_beside(std::size_t k, std::span<const std::size_t> others) const {
    const auto at = place(k);
    if (!at) return std::numeric_limits<double>::infinity();
    std::vector<Eigen::Index> given;
    for (const std::size_t other : others)
      if (const auto there = place(other)) given.push_back(*there);
    const auto variance = [&](const Eigen::MatrixXd& of) {
      if (given.empty()) return of(*at, *at);
      const Eigen::VectorXd with_given = of(given, *at);
      return of(*at, *at) - with_given.dot(submatrix(of, given).ldlt().solve(with_given));
    };
    return std::sqrt(std::max({variance(inverse_), variance(by_scores_), 0.0})) * scale_(*at);
  }
  [[nodiscard]] double of_difference(std::size_t k, std::size_t other) const {
    const auto a = place(k), b = place(other);
    if (!a || !b) return std::numeric_limits<double>::infinity();
    const auto variance = [&](const Eigen::MatrixXd& of) {
      return of(*a, *a) * scale_(*a) * scale_(*a) + of(*b, *b) * scale_(*b) * scale_(*b) -
             2.0 * of(*a, *b) * scale_(*a) * scale_(*b);
    };
    return std::sqrt(std::max({variance(inverse_), variance(by_scores_), 0.0}));
  }

 private:
  [[nodiscard]] std::optional<Eigen::Index> place(std::size_t k) const {
    const auto at = std::ranges::find(told_, static_cast<Eigen::Index>(k));
    return at == told_.end() ? std::nullopt : std::optional<Eigen::Index>(at - told_.begin());
  }

  std::vector<Eigen::Index> told_;
  Eigen::VectorXd scale_;
  Eigen::MatrixXd inverse_, by_scores_;
};

}  // namespace

namespace {

// In the unknown's own unit.
double in_its_unit(const FittedModel& model, std::size_t k, double error) {
  if (!std::isfinite(error)) return error;
  return error * std::abs(model.problem.shared[k].slope(model.optimum.point.shared[k]));
}

}  // namespace

std::vector<double> standard_errors(const FittedModel& model) {
  const Covariance covariance(model);
  std::vector<double> errors;
  for (std::size_t k = 0; k < model.problem.shared.size(); ++k)
    errors.push_back(in_its_unit(model, k, covariance.standard_error(k)));
  return errors;
}

std::vector<double> standard_errors_beside(const FittedModel& model, std::span<const std::size_t> unknowns,
                                           std::span<const std::size_t> given) {
  const Covariance covariance(model);
  std::vector<double> errors;
  for (const std::size_t k : unknowns)
    errors.push_back(in_its_unit(model, k, covariance.standard_error_beside(k, given)));
  return errors;
}

double standard_errors_apart(const FittedModel& model, std::span<const std::size_t> unknowns) {
  const Covariance covariance(model);
  double furthest = 0.0;
  for (const std::size_t k : unknowns) {
    if (!std::isfinite(covariance.standard_error(k))) return 0.0;
    for (const std::size_t other : unknowns)
      if (const double error = covariance.of_difference(k, other); k < other && error > 0.0)
        furthest =
            std::max(furthest, std::abs(model.optimum.point.shared[k] - model.optimum.point.shared[other]) / error);
  }
  return furthest;
}

}  // namespace sealwatch::mismatch

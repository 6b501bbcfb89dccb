#include "services/common/mismatch/standard_errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "services/common/dense/dense.hpp"
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
  normal.information += dense::product_transposed(jacobian.transpose(), jacobian.transpose());
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

}  // namespace

std::vector<double> standard_errors(const FittedModel& model) {
  const auto shared = static_cast<Eigen::Index>(model.problem.shared.size());
  Normal normal{.information = Eigen::MatrixXd::Zero(shared, shared), .scores = Eigen::MatrixXd::Zero(shared, shared)};
  for (std::size_t k = 0; k < model.optimum.at_optimum.size(); ++k) {
    const Linearisation& kept = model.optimum.at_optimum[k];
    // Of trials that came out far from the best the derivatives were not kept.
    if (kept.jacobian.size() > 0)
      add_recording(kept, model.problem.recordings[k].time_s, normal);
    else if (const auto again = linearise(model.problem, k, model.optimum.point.shared, model.optimum.point.own[k]))
      add_recording(*again, model.problem.recordings[k].time_s, normal);
  }
  if (normal.blocks > 1) normal.scores *= normal.blocks / (normal.blocks - 1.0);
  Eigen::MatrixXd prior = Eigen::MatrixXd::Zero(shared, shared);
  for (std::size_t k = 0; k < model.problem.shared.size(); ++k)
    if (const Unknown& unknown = model.problem.shared[k]; unknown.is_known())
      prior(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(k)) = 1.0 / std::pow(unknown.prior_std, 2);

  const double phi = dispersion(model);
  const Eigen::MatrixXd information = normal.information / phi + prior;
  const std::vector<Eigen::Index> told = told_by_data(model, information);
  const Eigen::VectorXd scale = subvector(information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse(), told);
  const auto scaled = [&](const Eigen::MatrixXd& matrix) -> Eigen::MatrixXd {
    return dense::scaled(submatrix(matrix, told), scale);
  };
  Eigen::MatrixXd a = scaled(information);
  a.diagonal().array() += 1e-12;
  const Eigen::MatrixXd inverse = dense::inverse(a);
  const Eigen::MatrixXd by_scores =
      dense::product(dense::product(inverse, scaled(normal.scores / (phi * phi) + prior)), inverse);
  std::vector<double> errors(model.problem.shared.size(), std::numeric_limits<double>::infinity());
  for (std::size_t j = 0; j < told.size(); ++j) {
    const auto at = static_cast<Eigen::Index>(j);
    const auto k = static_cast<std::size_t>(told[j]);
    errors[k] = std::sqrt(std::max(inverse(at, at), by_scores(at, at))) * scale(at) *
                std::abs(model.problem.shared[k].slope(model.optimum.point.shared[k]));
  }
  return errors;
}

}  // namespace sealwatch::mismatch

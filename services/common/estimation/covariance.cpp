#include "sealwatch/estimation/covariance.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

#include "services/common/dense/dense.hpp"

namespace sealwatch {
namespace {

constexpr double kShareInUnseenDirection = 1e-4;  // squared component above which a parameter counts as not identified
constexpr double kLargestAutocorrelation = 0.97;  // keeps Andrews' bandwidth finite for scores that hardly change
constexpr Eigen::Index kSamplesPerLag = 8;        // the bandwidth never exceeds this share of the recording

// Andrews (1991), Bartlett kernel, AR(1) for each score: 1.1447 (alpha T)^(1/3).
Eigen::Index bartlett_bandwidth(const Eigen::MatrixXd& scores) {
  double numerator = 0.0, denominator = 0.0;
  const Eigen::Index last = scores.rows() - 1;
  for (Eigen::Index j = 0; j < scores.cols(); ++j) {
    const double variance = scores.col(j).squaredNorm();
    if (!(variance > 0.0)) continue;
    const double rho =
        std::clamp(scores.col(j).head(last).dot(scores.col(j).tail(last)) / variance, 0.0, kLargestAutocorrelation);
    // Scores differ in size by their parameter's scale: each counts the same.
    numerator += 4.0 * rho * rho / (std::pow(1.0 - rho, 6) * std::pow(1.0 + rho, 2));
    denominator += 1.0 / std::pow(1.0 - rho, 4);
  }
  if (!(denominator > 0.0)) return 0;
  const double bandwidth = 1.1447 * std::cbrt(numerator / denominator * static_cast<double>(scores.rows()));
  return std::min(static_cast<Eigen::Index>(bandwidth), scores.rows() / kSamplesPerLag);
}

}  // namespace

Covariance covariance_of(const Eigen::MatrixXd& root) {
  const Eigen::Index n = root.cols();
  if (n == 0) return {};
  Eigen::VectorXd scale = root.colwise().norm();
  for (double& value : scale)
    if (!(value > 0.0)) value = 1.0;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(root * scale.cwiseInverse().asDiagonal(),
                                              Eigen::ComputeThinU | Eigen::ComputeFullV);
  const Eigen::VectorXd& values = svd.singularValues();
  const double smallest = values.size() > 0 ? kSmallestSingularValue * values(0) : 0.0;
  Covariance result{.matrix = Eigen::MatrixXd::Zero(n, n),
                    .identified = std::vector<bool>(static_cast<std::size_t>(n), true)};
  Eigen::VectorXd unseen = Eigen::VectorXd::Zero(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto direction = svd.matrixV().col(k);
    if (k < values.size() && values(k) > smallest)
      result.matrix += direction * direction.transpose() / (values(k) * values(k));
    else
      unseen += direction.cwiseAbs2();
  }
  result.matrix = dense::scaled(result.matrix, scale.cwiseInverse());
  for (Eigen::Index j = 0; j < n; ++j) {
    if (unseen(j) <= kShareInUnseenDirection) continue;
    result.identified[static_cast<std::size_t>(j)] = false;
    result.matrix.row(j).setZero();
    result.matrix.col(j).setZero();
    result.matrix(j, j) = std::numeric_limits<double>::infinity();
  }
  return result;
}

Eigen::MatrixXd long_run_variance(const Eigen::MatrixXd& scores) {
  Eigen::MatrixXd sum = dense::transposed_product(scores, scores);
  const Eigen::Index bandwidth = bartlett_bandwidth(scores);
  for (Eigen::Index lag = 1; lag <= bandwidth; ++lag) {
    const Eigen::Index rows = scores.rows() - lag;
    const Eigen::MatrixXd product = dense::transposed_product(scores.bottomRows(rows), scores.topRows(rows));
    const double weight = 1.0 - static_cast<double>(lag) / static_cast<double>(bandwidth + 1);
    sum += weight * (product + product.transpose());
  }
  return sum;
}

double inflate_for_coloured_residuals(Covariance& covariance, const Eigen::MatrixXd& scores) {
  const Eigen::Index n = covariance.matrix.rows();
  if (n == 0) return 1.0;
  Eigen::MatrixXd finite = covariance.matrix;
  for (Eigen::Index j = 0; j < n; ++j)
    if (!covariance.identified[static_cast<std::size_t>(j)]) finite(j, j) = 0.0;
  const Eigen::MatrixXd sandwich = dense::product(dense::product(finite, long_run_variance(scores)), finite);
  Eigen::VectorXd factor = Eigen::VectorXd::Ones(n);
  for (Eigen::Index j = 0; j < n; ++j)
    if (finite(j, j) > 0.0) factor(j) = std::sqrt(std::max(1.0, sandwich(j, j) / finite(j, j)));
  for (Eigen::Index j = 0; j < n; ++j)
    for (Eigen::Index k = 0; k < n; ++k) covariance.matrix(j, k) *= factor(j) * factor(k);
  return factor.maxCoeff();
}

}  // namespace sealwatch

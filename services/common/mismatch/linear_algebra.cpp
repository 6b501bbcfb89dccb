#include "services/common/mismatch/linear_algebra.hpp"

#include <algorithm>

namespace sealwatch::mismatch {

LinearStep bounded_step(const Eigen::MatrixXd& gram, const Eigen::VectorXd& gradient,
                        const std::vector<bool>& positive) {
  LinearStep step;
  std::vector<bool> held(positive.size(), false);
  for (std::size_t round = 0; round <= positive.size(); ++round) {
    Eigen::MatrixXd g = gram;
    Eigen::VectorXd right = gradient;
    for (std::size_t k = 0; k < held.size(); ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      const double diagonal = std::max(gram(row, row), 1e-300);
      if (held[k]) g.row(row).setZero(), g.col(row).setZero(), right(row) = 0.0;
      g(row, row) = held[k] ? 1.0 : diagonal * (1.0 + kRidge);
    }
    step.strength = dense::Symmetric(g).solve(right);
    step.gain = right.dot(step.strength);
    bool violated = false;
    for (std::size_t k = 0; k < held.size(); ++k)
      if (positive[k] && !held[k] && step.strength(static_cast<Eigen::Index>(k)) < 0.0) held[k] = violated = true;
    if (!violated) return step;
    step.free = false;
  }
  step.gain = 0.0;
  return step;
}

double quadratic(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& vector) {
  const Eigen::VectorXd scale = matrix.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd scaled = dense::scaled(matrix, scale);
  scaled.diagonal().array() += 1e-9;
  const Eigen::VectorXd right = scale.asDiagonal() * vector;
  return right.dot(dense::Symmetric(scaled).solve(right));
}

Eigen::MatrixXd submatrix(const Eigen::MatrixXd& matrix, const std::vector<Eigen::Index>& at) {
  const auto n = static_cast<Eigen::Index>(at.size());
  Eigen::MatrixXd sub(n, n);
  for (Eigen::Index j = 0; j < n; ++j)
    for (Eigen::Index k = 0; k < n; ++k)
      sub(j, k) = matrix(at[static_cast<std::size_t>(j)], at[static_cast<std::size_t>(k)]);
  return sub;
}

Eigen::VectorXd subvector(const Eigen::VectorXd& vector, const std::vector<Eigen::Index>& at) {
  Eigen::VectorXd sub(static_cast<Eigen::Index>(at.size()));
  for (Eigen::Index k = 0; k < sub.size(); ++k) sub(k) = vector(at[static_cast<std::size_t>(k)]);
  return sub;
}

}  // namespace sealwatch::mismatch

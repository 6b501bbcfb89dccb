// The minimum of a quadratic form within ranges.
#pragma once

#include <Eigen/Core>

namespace sealwatch {

/// d that minimises d'(G + damping diag G) d / 2 + g'd with low <= d <= high, entry by entry; ends of the ranges may be
/// infinite. G positive semidefinite, n x n; damping > 0: directions in which G, scaled by its diagonal, is flatter than
/// that are hardly moved.
/// Primal active set method (J. Nocedal, S. Wright, Numerical Optimization, 2nd ed., 2006, algorithm 16.3).
[[nodiscard]] Eigen::VectorXd minimum_in_box(const Eigen::MatrixXd& gram, const Eigen::VectorXd& gradient,
                                             const Eigen::VectorXd& low, const Eigen::VectorXd& high, double damping);

}  // namespace sealwatch

// Covariance of least-squares estimates, with rank loss shown and with residuals that may be correlated in time.
//
//   white residuals     C = (J'J)^-1                                   J = d(whitened residual)/d(parameter)
//   coloured residuals  C S C,  S = sum_l w_l sum_t s_t s_t-l'         s_t = J_t' r_t, the score of sample t
//                       (Newey and West 1987: Bartlett weights w_l, bandwidth after Andrews 1991)
//
// J'J is inverted through the singular values of J with its columns scaled to one. A direction whose singular value is
// below kSmallestSingularValue of the largest is not seen by the data: every parameter with a part in it gets an
// infinite variance, never a small false one.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace sealwatch {

inline constexpr double kSmallestSingularValue = 1e-7;

struct Covariance {
  Eigen::MatrixXd matrix;        ///< infinite on the diagonal and 0 beside it where not identified
  std::vector<bool> identified;  ///< per parameter
};

/// `root` has any number of rows, root'root = J'J.
[[nodiscard]] Covariance covariance_of(const Eigen::MatrixXd& root);

/// S: long-run variance of the sum of the rows of `scores` (samples x parameters).
[[nodiscard]] Eigen::MatrixXd long_run_variance(const Eigen::MatrixXd& scores);

/// Raises the standard errors in `covariance` to those of the sandwich where these are larger; correlations stay.
/// Returns the largest factor by which one was raised.
double inflate_for_coloured_residuals(Covariance& covariance, const Eigen::MatrixXd& scores);

}  // namespace sealwatch

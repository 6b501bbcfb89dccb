// Linear regression with noise that is correlated in time.
//
//   y = X beta + e,   e_t = a_1 e_(t-1) + ... + a_p e_(t-p) + w_t,   w_t white, variance s^2
//
// Coefficients a by Burg's method on what the regression leaves, beta by least squares on the filtered data, in turn until
// both stay (Cochrane and Orcutt 1949). What is filtered is summed up as it comes: a recording has many rows. -2 log L = n log s^2 + const compares models of the same n; both sides of a
// comparison have noise of their own, so that neither smooth noise is taken for a difference nor a difference for noise.
//
// Effective number of samples, of a mean:  n_eff = n gamma_0 (1 - a_1 - ... - a_p)^2 / s^2, gamma_0 variance of e.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

namespace sealwatch::trace {

/// Coefficients a_1 ... a_p, by Burg (1975): always stable.
[[nodiscard]] std::vector<double> burg(std::span<const double> values, std::size_t order);

/// The order up to `largest` with the least n log s_p^2 + p log n.
[[nodiscard]] std::size_t choose_order(std::span<const double> values, std::size_t largest);

/// Where a course goes on after a gap: indices of the first samples behind each. Noise before a gap tells nothing of the
/// noise behind it, so that `first` samples behind it condition the likelihood as those at the begin do.
using Joints = std::vector<Eigen::Index>;

/// Those of the `count` samples from `first` on, counted from there.
[[nodiscard]] Joints joints_within(const Joints& joints, Eigen::Index first, Eigen::Index count);

/// The t in first <= t < count whose `first` samples before them are of one piece.
[[nodiscard]] std::vector<Eigen::Index> whole_windows(Eigen::Index count, std::size_t first, const Joints& joints);

/// w_t = x_t - a_1 x_(t-1) - ... for the t of whole_windows() (first >= p), column by column.
[[nodiscard]] Eigen::MatrixXd whitened(const Eigen::Ref<const Eigen::MatrixXd>& columns,
                                       const std::vector<double>& coefficients, std::size_t first,
                                       const Joints& joints = {});

/// The same of [X y], as products: [X y]'[X y].
[[nodiscard]] Eigen::MatrixXd whitened_gram(const Eigen::Ref<const Eigen::MatrixXd>& X, const Eigen::VectorXd& y,
                                            const std::vector<double>& coefficients, std::size_t first,
                                            const Joints& joints = {});

struct ColouredFit {
  Eigen::VectorXd beta;
  Eigen::MatrixXd covariance;
  std::vector<double> coefficients;  ///< of the noise
  double innovation_variance = 0.0;
  double minus_two_log_likelihood = 0.0;  ///< up to a constant of `y.size() - first`
  Eigen::VectorXd residual;               ///< y - X beta
};

/// `order` of the noise; the first `first` samples (at least `order`) condition the likelihood. `least_variance`: what the
/// innovations have at least, by rounding.
[[nodiscard]] ColouredFit fit_coloured(const Eigen::VectorXd& y, const Eigen::Ref<const Eigen::MatrixXd>& X,
                                       std::size_t order, std::size_t first, double least_variance,
                                       const Joints& joints = {});

/// n_eff of noise with these coefficients, 1 to n.
[[nodiscard]] double effective_samples(const Eigen::VectorXd& noise, const std::vector<double>& coefficients);

}  // namespace sealwatch::trace

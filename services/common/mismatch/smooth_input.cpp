#include "services/common/mismatch/smooth_input.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "services/common/dense/dense.hpp"
#include "services/common/dense/row_products.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr std::size_t kMostKnots = 121, kFewestKnots = 4, kSamplesPerKnot = 4;
constexpr double kLevelShown = 0.02;  // share of a constant's effect that the recording's own unknowns leave
constexpr double kJitter = 1e-10;     // of the mean diagonal: a knot that the data do not show
constexpr double kLowestLambda = -8.0, kHighestLambda = 10.0, kLambdaStep = 0.25;  // decades

// Takes what the columns of `own` explain off; how many of them are independent.
Eigen::Index take_off(const RowMatrix& own, RowMatrix& hats, Eigen::VectorXd& residual) {
  if (own.cols() == 0) return 0;
  const Eigen::MatrixXd basis = dense::orthonormal_basis_of_scaled(Eigen::MatrixXd(own));
  const Eigen::MatrixXd like_own = dense::product(hats.transpose(), basis);
  dense::subtract_product(hats.transpose(), like_own, basis.transpose());
  residual -= basis * Eigen::VectorXd(basis.transpose() * residual);
  return basis.cols();
}

// D'D of second differences.
Eigen::MatrixXd roughness(Eigen::Index knots) {
  Eigen::MatrixXd difference = Eigen::MatrixXd::Zero(knots - 2, knots);
  for (Eigen::Index k = 0; k + 2 < knots; ++k) difference.row(k).segment(k, 3) << 1.0, -2.0, 1.0;
  return dense::transposed_product(difference, difference);
}

// The normal equations, in units in which the mean diagonal of the data's part is 1.
struct Normal {
  Eigen::MatrixXd gram;  ///< the data's part
  Eigen::VectorXd gradient;
  double residual_square = 0.0;
  double freedom = 1.0;  ///< N - rank Z
  bool level_known = true;
};

struct Ridge {
  Eigen::MatrixXd covariance;  ///< over phi
  Eigen::VectorXd value;
  double left = 0.0;  ///< |r~ - H~ w|^2
  double used = 0.0;  ///< effective number of knots
};

double minus_two_log_evidence(const Normal& normal, const Eigen::MatrixXd& steady, const Eigen::MatrixXd& rough,
                              double lambda) {
  const Eigen::LLT<Eigen::MatrixXd> llt(steady + lambda * rough);
  if (llt.info() != Eigen::Success) return std::numeric_limits<double>::infinity();
  const double determinant = 2.0 * llt.matrixLLT().diagonal().array().log().sum();
  const double left = normal.residual_square - normal.gradient.dot(llt.solve(normal.gradient));
  return (normal.freedom - 2.0) * std::log(std::max(left, 1e-12 * normal.residual_square)) + determinant -
         static_cast<double>(rough.rows() - 2) * std::log(lambda);
}

std::optional<Ridge> solve(const Normal& normal) {
  const Eigen::Index knots = normal.gram.rows();
  const Eigen::MatrixXd rough = roughness(knots);
  Eigen::MatrixXd steady = normal.gram;
  steady.diagonal().array() += kJitter;
  if (!normal.level_known) steady.array() += 1.0 / static_cast<double>(knots);
  double best = 1.0, least = std::numeric_limits<double>::infinity();
  for (double decade = kLowestLambda; decade <= kHighestLambda; decade += kLambdaStep) {
    const double lambda = std::pow(10.0, decade);
    const double value = minus_two_log_evidence(normal, steady, rough, lambda);
    if (value < least) least = value, best = lambda;
  }
  const Eigen::LLT<Eigen::MatrixXd> llt(steady + best * rough);
  if (llt.info() != Eigen::Success) return std::nullopt;
  Ridge ridge{.covariance = llt.solve(Eigen::MatrixXd::Identity(knots, knots)), .value = llt.solve(normal.gradient)};
  ridge.left = std::max(
      normal.residual_square - 2.0 * normal.gradient.dot(ridge.value) + ridge.value.dot(normal.gram * ridge.value),
      1e-12 * normal.residual_square);
  ridge.used = ridge.covariance.cwiseProduct(normal.gram).sum();
  return ridge;
}

}  // namespace

Knots::Place Knots::at(double t) const {
  const double place = std::clamp((t - begin_s) / spacing_s, 0.0, static_cast<double>(count - 1));
  const std::size_t knot = std::min(static_cast<std::size_t>(place), count - 2);
  return {knot, place - static_cast<double>(knot)};
}

Knots make_knots(const std::vector<double>& time_s) {
  const double duration_s = time_s.back() - time_s.front();
  const std::size_t count = std::clamp(time_s.size() / kSamplesPerKnot, kFewestKnots, kMostKnots);
  return {time_s.front(), duration_s / static_cast<double>(count - 1), count};
}

std::vector<double> hat_means(const Knots& knots, const std::vector<double>& time_s,
                              const std::vector<double>& values) {
  std::vector<double> sum(knots.count, 0.0), weight(knots.count, 0.0);
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double before = time_s[k == 0 ? 0 : k - 1], after = time_s[std::min(k + 1, values.size() - 1)];
    const auto [knot, share] = knots.at(time_s[k]);
    for (const auto& [at, part] : {std::pair(knot, 1.0 - share), std::pair(knot + 1, share)}) {
      sum[at] += part * (after - before) * values[k];
      weight[at] += part * (after - before);
    }
  }
  for (std::size_t k = 0; k < knots.count; ++k) sum[k] = weight[k] > 0.0 ? sum[k] / weight[k] : 0.0;
  return sum;
}

HatColumns::HatColumns(Knots knots, const std::vector<std::size_t>& sites) : knots_(knots), sites_(sites.size()) {
  for (std::size_t knot = 0; knot < knots_.count; ++knot)
    for (const std::size_t site : sites) entries_.push_back({.column = knot, .site = site});
}

void HatColumns::weigh(double t, Signals, std::span<double> weights) {
  std::ranges::fill(weights, 0.0);
  const auto [knot, share] = knots_.at(t);
  for (std::size_t k = 0; k < sites_; ++k) {
    weights[knot * sites_ + k] = 1.0 - share;
    weights[(knot + 1) * sites_ + k] = share;
  }
}

Result<SmoothInput> smooth_input(RowMatrix hats, const RowMatrix& own, Eigen::VectorXd residual) {
  const Eigen::Index knots = hats.cols();
  const auto count = static_cast<double>(knots);
  const Eigen::VectorXd constant = Eigen::VectorXd::Ones(knots);
  const double level_before = (hats * constant).squaredNorm();
  const double unit = std::sqrt(hats.squaredNorm() / count);
  if (!(unit > 0.0) || !std::isfinite(unit)) return fail("the recording does not depend on this input");
  const Eigen::Index rank = take_off(own, hats, residual);
  hats /= unit;
  Normal normal{.gram = dense::gram_of_rows(hats),
                .gradient = hats.transpose() * residual,
                .residual_square = residual.squaredNorm(),
                .freedom = static_cast<double>(residual.size() - rank)};
  const double level_after = constant.dot(normal.gram * constant) * unit * unit;
  normal.level_known = level_after > kLevelShown * level_before;

  std::optional<Ridge> ridge = solve(normal);
  if (!ridge) return fail("the recording does not tell this input");
  SmoothInput result{.value = std::move(ridge->value),
                     .standard_error = {},
                     .dispersion = ridge->left / std::max(normal.freedom - ridge->used, 1.0),
                     .level_known = normal.level_known};
  if (!result.level_known) {
    const Eigen::MatrixXd centre =
        Eigen::MatrixXd::Identity(knots, knots) - Eigen::MatrixXd::Constant(knots, knots, 1.0 / count);
    result.value = (centre * result.value).eval();
    ridge->covariance = dense::product(dense::product(centre, ridge->covariance), centre);
  }
  result.value /= unit;
  result.standard_error =
      ridge->covariance.diagonal().cwiseMax(0.0).cwiseSqrt() * std::sqrt(std::max(1.0, result.dispersion)) / unit;
  return result;
}

}  // namespace sealwatch::mismatch

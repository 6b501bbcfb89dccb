#include "services/common/mismatch/screening_scores.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <utility>

#include "sealwatch/signal/statistics.hpp"
#include "services/common/dense/dense.hpp"
#include "services/common/estimation/minimum_in_box.hpp"
#include "services/common/mismatch/linear_algebra.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kDetectable = 27.0;  // lambda: noncentrality that is seen with 80 % power at 1 % over the catalogue
constexpr double kAbsurd = 100.0;     // usual sizes
constexpr double kMeasured = 0.05;    // resolution above which the input must have been measured

std::vector<bool> sign_bounds(const Screening& screening, const Variant& variant) {
  const Candidate& candidate = screening.candidates[variant.candidate];
  const std::vector<std::size_t> strengths = strengths_of(*candidate.law);
  std::vector<bool> positive(variant.columns.size(), false);
  if (positive.size() == strengths.size())  // else a free angle: sine and cosine of either sign
    for (std::size_t k = 0; k < strengths.size(); ++k) positive[k] = candidate.law->parameters[strengths[k]].min >= 0.0;
  return positive;
}

// k_0 in usual sizes. `gram`: of the variant's columns, each for a usual size.
Eigen::VectorXd resolution_of(const Screening& screening, const Variant& variant, const Eigen::MatrixXd& gram,
                              double residuals, const Resolution& resolution) {
  const Candidate& candidate = screening.candidates[variant.candidate];
  const std::vector<std::size_t> strengths = strengths_of(*candidate.law);
  Eigen::VectorXd least = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(variant.columns.size()));
  for (Eigen::Index k = 0; k < least.size(); ++k) {
    const LawParameter& strength =
        candidate.law->parameters[strengths[std::min(static_cast<std::size_t>(k), strengths.size() - 1)]];
    const double unit =
        std::abs(screening.unit[static_cast<std::size_t>(variant.columns[static_cast<std::size_t>(k)])]);
    const bool bias = is_bias(candidate.law->kind);
    const double moved = std::sqrt(std::max(gram(k, k), 0.0) / residuals) / unit;
    least(k) = bias ? resolution.share : resolution.of(strength, moved) / unit;
  }
  return least;
}

// The law together with the unknowns that are held at an end of their range, which come back as far as they may.
struct Beside {
  double gain = 0.0;
  Eigen::VectorXd strength, back;
};

Beside step_beside_held(const Screening& screening, const std::vector<Eigen::Index>& columns,
                        const std::vector<bool>& positive) {
  constexpr double kEnd = std::numeric_limits<double>::infinity();
  const HeldUnknowns& held = screening.held;
  if (held.unknown.empty()) {
    LinearStep step =
        bounded_step(submatrix(screening.gram, columns), subvector(screening.gradient, columns), positive);
    return {.gain = step.gain, .strength = std::move(step.strength), .back = {}};
  }
  const Eigen::Index laws = std::ssize(columns), all = laws + std::ssize(held.unknown);
  Eigen::MatrixXd gram(all, all);
  Eigen::VectorXd gradient(all), least(all), most(all);
  const Eigen::MatrixXd across = held.across(Eigen::all, columns);
  gram << submatrix(screening.gram, columns), across.transpose(), across, held.gram;
  gradient << subvector(screening.gradient, columns), held.gradient;
  for (Eigen::Index k = 0; k < laws; ++k) least(k) = positive[static_cast<std::size_t>(k)] ? 0.0 : -kEnd;
  least.tail(all - laws) = held.least;
  most << Eigen::VectorXd::Constant(laws, kEnd), held.most;
  const Eigen::VectorXd step = minimum_in_box(gram, -gradient, least, most, kRidge);
  return {.gain = 2.0 * gradient.dot(step) - step.dot(gram * step),
          .strength = step.head(laws),
          .back = step.tail(all - laws)};
}

// V: covariance of the blocks' scores once the law's own best share is taken off them. An effect that acts in few
// blocks would otherwise hide in the scatter that it makes.
Eigen::MatrixXd variance_without(const Screening& screening, const Variant& variant,
                                 const Eigen::Ref<const Eigen::MatrixXd>& block_gram, const Eigen::VectorXd& strength) {
  const auto n = static_cast<Eigen::Index>(variant.columns.size());
  Eigen::MatrixXd rest(screening.block_scores.rows(), n);
  for (Eigen::Index j = 0; j < n; ++j)
    rest.col(j) = screening.block_scores.col(variant.columns[static_cast<std::size_t>(j)]) -
                  block_gram.middleCols(j * n, n) * strength;
  rest.rowwise() -= rest.colwise().mean().eval();
  return dense::transposed_product(rest, rest);
}

// The smaller of two scores: by the scatter between blocks, which knows noise of any colour but not from a few blocks,
// and by the noise as it was estimated.
double score_of(const Eigen::MatrixXd& gram, const Eigen::VectorXd& gradient, const Eigen::MatrixXd& variance,
                const Eigen::VectorXd& resolution, const Eigen::VectorXd& strength) {
  if (gradient.size() == 1) {
    const double beyond = std::max(0.0, std::abs(gradient(0)) - resolution(0) * gram(0, 0));
    return beyond * beyond / std::max({variance(0, 0), gram(0, 0), 1e-300});
  }
  const bool within = (strength.cwiseAbs().array() <= resolution.array()).all();
  return within && resolution.maxCoeff() > 0.0 ? 0.0
                                               : std::min(quadratic(variance, gradient), quadratic(gram, gradient));
}

}  // namespace

void evaluate(Screening& screening, const Eigen::VectorXd& raw_norm, const Eigen::MatrixXd& grams, double residuals,
              const Resolution& resolution) {
  Eigen::Index entry = 0;
  for (Variant& variant : screening.variants) {
    const Eigen::VectorXd gradient = subvector(screening.gradient, variant.columns);
    const Eigen::MatrixXd gram = submatrix(screening.gram, variant.columns);
    const LinearStep step = bounded_step(gram, gradient, sign_bounds(screening, variant));
    const Eigen::VectorXd least = resolution_of(screening, variant, gram, residuals, resolution);
    const auto entries = static_cast<Eigen::Index>(variant.columns.size() * variant.columns.size());
    const Eigen::VectorXd own = bounded_step(gram, gradient, std::vector<bool>(variant.columns.size(), false)).strength;
    const Eigen::MatrixXd variance =
        variance_without(screening, variant, grams.middleCols(std::exchange(entry, entry + entries), entries), own);
    variant.score = score_of(gram, gradient, variance, least, step.strength);
    // With an input that is itself measured only what a law could be counts: its sign, and no absurd size.
    const bool possible = step.free && step.strength.cwiseAbs().maxCoeff() < kAbsurd;
    if ((resolution.share > kMeasured && !possible) || !std::isfinite(variant.score)) variant.score = 0.0;
    variant.p_value = signal::chi_squared_tail(variant.score, static_cast<double>(variant.columns.size()));
    const Beside beside = step_beside_held(screening, variant.columns, sign_bounds(screening, variant));
    variant.gain = std::isfinite(beside.gain) ? beside.gain : 0.0;  // columns of zeros: the law cannot act here
    variant.back.assign(beside.back.begin(), beside.back.end());
    variant.physical = step.free;
    for (Eigen::Index k = 0; k < beside.strength.size(); ++k)
      variant.strength.push_back(
          beside.strength(k) * screening.unit[static_cast<std::size_t>(variant.columns[static_cast<std::size_t>(k)])]);
    const Eigen::Index first = variant.columns.front();
    variant.absorbed = raw_norm(first) > 0.0 ? 1.0 - gram(0, 0) / raw_norm(first) : 1.0;
    variant.minimum_detectable = gram(0, 0) > 0.0 ? (std::sqrt(kDetectable / gram(0, 0)) + least(0)) *
                                                        std::abs(screening.unit[static_cast<std::size_t>(first)])
                                                  : std::numeric_limits<double>::infinity();
  }
}

void calibrate(Screening& screening, const ScreeningOptions& options) {
  if (screening.variants.empty()) return;  // no law fits: a plant whose sites have no closed forms
  const Eigen::VectorXd scale = screening.gram.diagonal().cwiseMax(1e-300).cwiseSqrt();
  Eigen::MatrixXd correlation = dense::scaled(screening.gram, scale.cwiseInverse());
  correlation.diagonal().array() += kRidge;
  const dense::Symmetric factor(correlation);
  const Eigen::VectorXd roots = factor.pivots().cwiseMax(0.0).cwiseSqrt();
  std::mt19937_64 random(options.seed);
  std::normal_distribution<double> normal;
  std::vector<double> smallest;
  std::vector<Eigen::MatrixXd> inverse;
  for (const Variant& variant : screening.variants) {
    Eigen::MatrixXd own = submatrix(correlation, variant.columns);
    own.diagonal().array() += 1e-9;
    inverse.push_back(dense::inverse(own));
  }
  for (int draw = 0; draw < options.draws; ++draw) {
    Eigen::VectorXd white(roots.size());
    for (double& value : white) value = normal(random);
    const Eigen::VectorXd drawn = factor.lower_times(roots.cwiseProduct(white));
    double least = 1.0;
    for (std::size_t k = 0; k < screening.variants.size(); ++k) {
      const Eigen::VectorXd g = subvector(drawn, screening.variants[k].columns);
      least = std::min(least, signal::chi_squared_tail(g.dot(inverse[k] * g), static_cast<double>(g.size())));
    }
    smallest.push_back(least);
  }
  // Of n independent tests the smallest p-value has the 1 - 0.5^(1/n) as its median; the tail matters more: 5 %.
  std::ranges::sort(smallest);
  const double at_5_percent = smallest[smallest.size() / 20];
  screening.effective_number = std::max(1.0, std::log1p(-0.05) / std::log1p(-std::min(at_5_percent, 0.049999)));
  for (const Candidate& candidate : screening.candidates)  // what was chosen from more was tested with all of them
    screening.effective_number += static_cast<double>(candidate.passed_over);
  const auto best = std::ranges::min_element(screening.variants, {}, &Variant::p_value);
  screening.best = static_cast<std::size_t>(best - screening.variants.begin());
  screening.p_value = -std::expm1(screening.effective_number * std::log1p(-std::min(best->p_value, 1.0 - 1e-16)));
}

void find_leakage_shifts(Screening& screening, const FittedModel& model, const Eigen::MatrixXd& gram,
                         const Eigen::MatrixXd& cross) {
  const std::string& wears = model.problem.recordings.front().simulation->plant().wear_parameter;
  const auto leakage = std::ranges::find(model.problem.shared, wears, parameter_of);
  if (leakage == model.problem.shared.end()) return;
  const auto row = static_cast<Eigen::Index>(leakage - model.problem.shared.begin());
  const Eigen::MatrixXd swallowed = NormalMatrix(gram).solve(cross);
  for (Variant& variant : screening.variants) {
    const Eigen::Index column = variant.columns.front();
    const double size = screening.gram(column, column);
    if (size > 0.0) variant.leakage_shift = std::abs(swallowed(row, column)) * std::sqrt(kDetectable / size);
  }
}

double pair_gain(const Screening& screening, const Variant& a, const Variant& b) {
  std::vector<Eigen::Index> columns = a.columns;
  columns.insert(columns.end(), b.columns.begin(), b.columns.end());
  std::vector<bool> positive = sign_bounds(screening, a);
  const std::vector<bool> other = sign_bounds(screening, b);
  positive.insert(positive.end(), other.begin(), other.end());
  return step_beside_held(screening, columns, positive).gain;
}

double similarity(const Screening& screening, const Variant& a, const Variant& b) {
  const Eigen::Index j = a.columns.front(), k = b.columns.front();
  const double size = std::sqrt(screening.gram(j, j) * screening.gram(k, k));
  return size > 0.0 ? std::abs(screening.gram(j, k)) / size : 0.0;
}

}  // namespace sealwatch::mismatch

#include "services/common/mismatch/screening.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <future>
#include <random>
#include <utility>

#include "services/common/mismatch/linear_algebra.hpp"
#include "services/common/mismatch/resolution.hpp"
#include "services/common/mismatch/sensitivity_pass.hpp"
#include "services/common/mismatch/tail.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kDetectable = 27.0;  // lambda: noncentrality that is seen with 80 % power at 1 % over the catalogue
constexpr double kAbsurd = 100.0;     // usual sizes
constexpr double kMeasured = 0.05;    // resolution above which the input must have been measured

// One recording with its own unknowns taken off.
struct Reduced {
  RowMatrix shared, laws;
  Eigen::VectorXd residual;
  Eigen::VectorXd raw_norm;  ///< |s_j|^2 before anything was taken off
  Eigen::Index channels = 0;
};

Result<Reduced> reduce(const FittedModel& model, std::size_t recording, const std::vector<Candidate>& candidates,
                       const std::vector<PassColumn>& columns) {
  Result<Pass> pass = sensitivity_pass(model, recording, candidates, columns);
  if (!pass) return fail(pass.error());
  const auto shared = static_cast<Eigen::Index>(model.problem.shared.size());
  const RowMatrix own = pass->free.rightCols(pass->free.cols() - shared);
  Reduced reduced{.shared = pass->free.leftCols(shared),
                  .laws = std::move(pass->laws),
                  .residual = std::move(pass->residual),
                  .raw_norm = {},
                  .channels = pass->channels};
  for (std::size_t k = 0; k < model.problem.shared.size(); ++k) {  // what is held at a bound does not swallow anything
    const Unknown& unknown = model.problem.shared[k];
    const double at = model.optimum.point.shared[k];
    if (at - unknown.to_unknown(unknown.min) < 1e-6 || unknown.to_unknown(unknown.max) - at < 1e-6)
      reduced.shared.col(static_cast<Eigen::Index>(k)).setZero();
  }
  reduced.raw_norm = reduced.laws.colwise().squaredNorm();
  const Projection projection(own);
  projection.remove_from(reduced.shared);
  projection.remove_from(reduced.laws);
  projection.remove_from(reduced.residual);
  return reduced;
}

// Columns of all recordings: those of a recording's own come once for each.
struct Layout {
  std::vector<std::vector<Eigen::Index>> of_pass;  ///< per pass column: one index, or one for each recording
  Eigen::Index size = 0;
};

Layout lay_out(const std::vector<PassColumn>& columns, std::size_t recordings) {
  Layout layout;
  for (const PassColumn& column : columns) {
    std::vector<Eigen::Index>& of = layout.of_pass.emplace_back();
    for (std::size_t k = 0; k < (column.own ? recordings : 1); ++k) of.push_back(layout.size++);
  }
  return layout;
}

RowMatrix spread(const RowMatrix& laws, const Layout& layout, std::size_t recording) {
  RowMatrix wide = RowMatrix::Zero(laws.rows(), layout.size);
  for (std::size_t k = 0; k < layout.of_pass.size(); ++k) {
    const auto& of = layout.of_pass[k];
    wide.col(of.size() == 1 ? of.front() : of[recording]) = laws.col(static_cast<Eigen::Index>(k));
  }
  return wide;
}

Eigen::MatrixXd block_sums(const RowMatrix& laws, const Eigen::VectorXd& residual, Eigen::Index rows_per_block) {
  const Eigen::Index blocks = std::max<Eigen::Index>(1, laws.rows() / rows_per_block);
  Eigen::MatrixXd sums(blocks, laws.cols());
  for (Eigen::Index b = 0; b < blocks; ++b) {
    const Eigen::Index begin = b * rows_per_block;
    const Eigen::Index count = b + 1 == blocks ? laws.rows() - begin : rows_per_block;
    sums.row(b) = laws.middleRows(begin, count).transpose() * residual.segment(begin, count);
  }
  return sums;
}

// s~_b' s~_b of each variant per block, its entries one after the other: what a law itself adds to its blocks' scores.
Eigen::MatrixXd block_grams(const RowMatrix& laws, const std::vector<Variant>& variants, Eigen::Index rows_per_block) {
  const Eigen::Index blocks = std::max<Eigen::Index>(1, laws.rows() / rows_per_block);
  Eigen::Index entries = 0;
  for (const Variant& variant : variants)
    entries += static_cast<Eigen::Index>(variant.columns.size() * variant.columns.size());
  Eigen::MatrixXd grams(blocks, entries);
  for (Eigen::Index b = 0; b < blocks; ++b) {
    const Eigen::Index begin = b * rows_per_block;
    const Eigen::Index count = b + 1 == blocks ? laws.rows() - begin : rows_per_block;
    const RowMatrix block = laws.middleRows(begin, count);
    Eigen::Index entry = 0;
    for (const Variant& variant : variants)
      for (const Eigen::Index j : variant.columns)
        for (const Eigen::Index k : variant.columns) grams(b, entry++) = block.col(j).dot(block.col(k));
  }
  return grams;
}

std::vector<bool> sign_bounds(const Screening& screening, const Variant& variant) {
  const Candidate& candidate = screening.candidates[variant.candidate];
  const std::vector<std::size_t> strengths = strengths_of(*candidate.law);
  std::vector<bool> positive(variant.columns.size(), false);
  if (positive.size() == strengths.size())  // else a free angle: sine and cosine of either sign
    for (std::size_t k = 0; k < strengths.size(); ++k) positive[k] = candidate.law->parameters[strengths[k]].min >= 0.0;
  return positive;
}

// k_0 in usual sizes.
Eigen::VectorXd resolution_of(const Screening& screening, const Variant& variant, const Resolution& resolution) {
  const Candidate& candidate = screening.candidates[variant.candidate];
  const std::vector<std::size_t> strengths = strengths_of(*candidate.law);
  Eigen::VectorXd least = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(variant.columns.size()));
  for (Eigen::Index k = 0; k < least.size(); ++k) {
    const LawParameter& strength =
        candidate.law->parameters[strengths[std::min(static_cast<std::size_t>(k), strengths.size() - 1)]];
    const double unit =
        std::abs(screening.unit[static_cast<std::size_t>(variant.columns[static_cast<std::size_t>(k)])]);
    const bool bias = candidate.law->kind == SiteKind::sensor_bias;
    least(k) = bias ? resolution.share : resolution.of(strength) / unit;
  }
  return least;
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
  return rest.transpose() * rest;
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

void evaluate(Screening& screening, const Eigen::VectorXd& raw_norm, const Eigen::MatrixXd& grams,
              const Resolution& resolution) {
  Eigen::Index entry = 0;
  for (Variant& variant : screening.variants) {
    const Eigen::VectorXd gradient = subvector(screening.gradient, variant.columns);
    const Eigen::MatrixXd gram = submatrix(screening.gram, variant.columns);
    const LinearStep step = bounded_step(gram, gradient, sign_bounds(screening, variant));
    const Eigen::VectorXd least = resolution_of(screening, variant, resolution);
    const auto entries = static_cast<Eigen::Index>(variant.columns.size() * variant.columns.size());
    const Eigen::VectorXd own = bounded_step(gram, gradient, std::vector<bool>(variant.columns.size(), false)).strength;
    const Eigen::MatrixXd variance =
        variance_without(screening, variant, grams.middleCols(std::exchange(entry, entry + entries), entries), own);
    variant.score = score_of(gram, gradient, variance, least, step.strength);
    // With an input that is itself measured only what a law could be counts: its sign, and no absurd size.
    const bool possible = step.free && step.strength.cwiseAbs().maxCoeff() < kAbsurd;
    if ((resolution.share > kMeasured && !possible) || !std::isfinite(variant.score)) variant.score = 0.0;
    variant.p_value = chi_squared_tail(variant.score, static_cast<double>(variant.columns.size()));
    variant.gain = std::isfinite(step.gain) ? step.gain : 0.0;  // columns of zeros: the law cannot act here
    variant.physical = step.free;
    for (Eigen::Index k = 0; k < step.strength.size(); ++k)
      variant.strength.push_back(
          step.strength(k) * screening.unit[static_cast<std::size_t>(variant.columns[static_cast<std::size_t>(k)])]);
    const Eigen::Index first = variant.columns.front();
    variant.absorbed = raw_norm(first) > 0.0 ? 1.0 - gram(0, 0) / raw_norm(first) : 1.0;
    variant.minimum_detectable = gram(0, 0) > 0.0 ? (std::sqrt(kDetectable / gram(0, 0)) + least(0)) *
                                                        std::abs(screening.unit[static_cast<std::size_t>(first)])
                                                  : std::numeric_limits<double>::infinity();
  }
}

// Smallest p-value of all variants when g is nothing but noise, N(0, G); how many independent tests it stands for.
void calibrate(Screening& screening, const ScreeningOptions& options) {
  const Eigen::VectorXd scale = screening.gram.diagonal().cwiseMax(1e-300).cwiseSqrt();
  Eigen::MatrixXd correlation = scale.cwiseInverse().asDiagonal() * screening.gram * scale.cwiseInverse().asDiagonal();
  correlation.diagonal().array() += kRidge;
  const Eigen::LDLT<Eigen::MatrixXd> factor(correlation);
  const Eigen::VectorXd roots = factor.vectorD().cwiseMax(0.0).cwiseSqrt();
  std::mt19937_64 random(options.seed);
  std::normal_distribution<double> normal;
  std::vector<double> smallest;
  std::vector<Eigen::MatrixXd> inverse;
  for (const Variant& variant : screening.variants) {
    Eigen::MatrixXd own = submatrix(correlation, variant.columns);
    own.diagonal().array() += 1e-9;
    inverse.push_back(own.inverse());
  }
  for (int draw = 0; draw < options.draws; ++draw) {
    Eigen::VectorXd white(roots.size());
    for (double& value : white) value = normal(random);
    const Eigen::VectorXd drawn =
        factor.transpositionsP().transpose() * Eigen::VectorXd(factor.matrixL() * roots.cwiseProduct(white));
    double least = 1.0;
    for (std::size_t k = 0; k < screening.variants.size(); ++k) {
      const Eigen::VectorXd g = subvector(drawn, screening.variants[k].columns);
      least = std::min(least, chi_squared_tail(g.dot(inverse[k] * g), static_cast<double>(g.size())));
    }
    smallest.push_back(least);
  }
  // Of n independent tests the smallest p-value has the 1 - 0.5^(1/n) as its median; the tail matters more: 5 %.
  std::ranges::sort(smallest);
  const double at_5_percent = smallest[smallest.size() / 20];
  screening.effective_number = std::max(1.0, std::log1p(-0.05) / std::log1p(-std::min(at_5_percent, 0.049999)));
  const auto best = std::ranges::min_element(screening.variants, {}, &Variant::p_value);
  screening.best = static_cast<std::size_t>(best - screening.variants.begin());
  screening.p_value = -std::expm1(screening.effective_number * std::log1p(-std::min(best->p_value, 1.0 - 1e-16)));
}

// How far a law of the smallest detectable size would move the estimate of the seal's leakage resistance, relative.
void find_leakage_shifts(Screening& screening, const FittedModel& model, const Eigen::MatrixXd& gram,
                         const Eigen::MatrixXd& cross) {
  const auto leakage = std::ranges::find(model.problem.shared, "R_CL", &Unknown::name);
  if (leakage == model.problem.shared.end()) return;
  const auto row = static_cast<Eigen::Index>(leakage - model.problem.shared.begin());
  const Eigen::VectorXd scale = gram.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd scaled = scale.asDiagonal() * gram * scale.asDiagonal();
  scaled.diagonal().array() += kRidge;
  const Eigen::MatrixXd swallowed = scale.asDiagonal() * scaled.ldlt().solve(scale.asDiagonal() * cross);
  for (Variant& variant : screening.variants) {
    const Eigen::Index column = variant.columns.front();
    const double size = screening.gram(column, column);
    if (size > 0.0) variant.leakage_shift = std::abs(swallowed(row, column)) * std::sqrt(kDetectable / size);
  }
}

std::vector<Variant> make_variants(const std::vector<PassColumn>& columns, const Layout& layout) {
  std::vector<Variant> variants;
  for (std::size_t k = 0; k < columns.size(); ++k) {
    if (variants.empty() || variants.back().candidate != columns[k].candidate ||
        variants.back().point != columns[k].point)
      variants.push_back({.candidate = columns[k].candidate, .point = columns[k].point, .columns = {}, .strength = {}});
    variants.back().columns.insert(variants.back().columns.end(), layout.of_pass[k].begin(), layout.of_pass[k].end());
  }
  return variants;
}

Eigen::MatrixXd stacked(const std::vector<Eigen::MatrixXd>& parts, Eigen::Index rows) {
  Eigen::MatrixXd all(rows, parts.front().cols());
  Eigen::Index at = 0;
  for (const Eigen::MatrixXd& part : parts) {
    all.middleRows(at, part.rows()) = part;
    at += part.rows();
  }
  return all;
}

Result<std::vector<Reduced>> reduce_all(const FittedModel& model, const std::vector<Candidate>& candidates,
                                        const std::vector<PassColumn>& columns, int threads) {
  std::vector<Reduced> all;
  const std::size_t count = model.problem.recordings.size();
  for (std::size_t first = 0; first < count; first += static_cast<std::size_t>(threads)) {
    std::vector<std::future<Result<Reduced>>> running;
    for (std::size_t k = first; k < std::min(count, first + static_cast<std::size_t>(threads)); ++k)
      running.push_back(std::async(std::launch::async, [&, k] { return reduce(model, k, candidates, columns); }));
    for (auto& one : running) {
      Result<Reduced> reduced = one.get();
      if (!reduced) return fail(reduced.error());
      all.push_back(std::move(*reduced));
    }
  }
  return all;
}

}  // namespace

Result<Screening> screen(const FittedModel& model, const Data& data, const ScreeningOptions& options) {
  Screening screening{.candidates = find_candidates(*model.problem.recordings.front().simulation, model.asset.physics,
                                                    options.closed_forms)};
  const std::vector<PassColumn> columns = pass_columns(screening.candidates);
  const Layout layout = lay_out(columns, data.samples.size());
  screening.variants = make_variants(columns, layout);
  screening.unit.resize(static_cast<std::size_t>(layout.size));
  for (std::size_t k = 0; k < columns.size(); ++k)
    for (const Eigen::Index index : layout.of_pass[k])
      screening.unit[static_cast<std::size_t>(index)] = columns[k].unit;
  Result<std::vector<Reduced>> parts = reduce_all(model, screening.candidates, columns, options.threads);
  if (!parts) return fail(parts.error());

  const auto shared = static_cast<Eigen::Index>(model.problem.shared.size());
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(shared, shared), cross = Eigen::MatrixXd::Zero(shared, layout.size);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(shared), raw_norm = Eigen::VectorXd::Zero(layout.size);
  for (std::size_t k = 0; k < parts->size(); ++k) {
    Reduced& part = (*parts)[k];
    part.laws = spread(part.laws, layout, k);
    gram += part.shared.transpose() * part.shared;
    cross += part.shared.transpose() * part.laws;
    right += part.shared.transpose() * part.residual;
    for (std::size_t c = 0; c < columns.size(); ++c)
      for (std::size_t j = 0; j < layout.of_pass[c].size(); ++j)
        if (layout.of_pass[c].size() == 1 || j == k)
          raw_norm(layout.of_pass[c][j]) += part.raw_norm(static_cast<Eigen::Index>(c));
  }
  screening.gram = Eigen::MatrixXd::Zero(layout.size, layout.size);
  std::vector<Eigen::MatrixXd> sums, grams;
  Eigen::Index blocks = 0;
  for (std::size_t k = 0; k < parts->size(); ++k) {
    Reduced& part = (*parts)[k];
    if (shared > 0) {
      const Projection projection(part.shared, gram);
      part.laws.noalias() -= part.shared * projection.coefficients(cross);
      part.residual.noalias() -= part.shared * projection.coefficients(right);
    }
    screening.gram.selfadjointView<Eigen::Lower>().rankUpdate(part.laws.transpose());
    const double rate = static_cast<double>(data.samples[k].time_s.size()) /
                        (data.samples[k].time_s.back() - data.samples[k].time_s.front());
    const auto rows = std::max<Eigen::Index>(1, static_cast<Eigen::Index>(options.block_s * rate)) * part.channels;
    sums.push_back(block_sums(part.laws, part.residual, rows));
    grams.push_back(block_grams(part.laws, screening.variants, rows));
    blocks += sums.back().rows();
    part.laws.resize(0, 0);
  }
  screening.gram.triangularView<Eigen::StrictlyUpper>() = screening.gram.transpose();
  screening.block_scores = stacked(sums, blocks);
  screening.gradient = screening.block_scores.colwise().sum();
  if (shared > 0) find_leakage_shifts(screening, model, gram, cross);
  evaluate(screening, raw_norm, stacked(grams, blocks),
           resolution_of(data, model.problem.recordings.front().simulation->plant()));
  calibrate(screening, options);
  return screening;
}

double pair_gain(const Screening& screening, const Variant& a, const Variant& b) {
  std::vector<Eigen::Index> columns = a.columns;
  columns.insert(columns.end(), b.columns.begin(), b.columns.end());
  std::vector<bool> positive = sign_bounds(screening, a);
  const std::vector<bool> other = sign_bounds(screening, b);
  positive.insert(positive.end(), other.begin(), other.end());
  return bounded_step(submatrix(screening.gram, columns), subvector(screening.gradient, columns), positive).gain;
}

double similarity(const Screening& screening, const Variant& a, const Variant& b) {
  const Eigen::Index j = a.columns.front(), k = b.columns.front();
  const double size = std::sqrt(screening.gram(j, j) * screening.gram(k, k));
  return size > 0.0 ? std::abs(screening.gram(j, k)) / size : 0.0;
}

}  // namespace sealwatch::mismatch

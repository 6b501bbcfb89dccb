#include "services/common/mismatch/screening.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "services/common/mismatch/in_parallel.hpp"
#include "services/common/mismatch/linear_algebra.hpp"
#include "services/common/mismatch/screening_scores.hpp"
#include "services/common/mismatch/sensitivity_pass.hpp"

namespace sealwatch::mismatch {
namespace {

// One recording with its own unknowns taken off.
struct Reduced {
  RowMatrix shared, laws;
  Eigen::VectorXd residual;
  Eigen::VectorXd raw_norm;  ///< |s_j|^2 before anything was taken off
  Eigen::Index rows_per_block = 1;
};

Eigen::Index rows_per_block(const std::vector<double>& time_s, Eigen::Index channels, double block_s) {
  const double rate = static_cast<double>(time_s.size()) / (time_s.back() - time_s.front());
  return std::max<Eigen::Index>(1, static_cast<Eigen::Index>(block_s * rate)) * channels;
}

Result<Reduced> reduce(const FittedModel& model, std::size_t recording, const std::vector<Candidate>& candidates,
                       const std::vector<PassColumn>& columns, double block_s) {
  Result<Pass> pass = sensitivity_pass(model, recording, candidates, columns);
  if (!pass) return fail(pass.error());
  const auto shared = static_cast<Eigen::Index>(model.problem.shared.size());
  const RowMatrix own = pass->free.rightCols(pass->free.cols() - shared);
  Reduced reduced{
      .shared = pass->free.leftCols(shared),
      .laws = std::move(pass->laws),
      .residual = std::move(pass->residual),
      .raw_norm = {},
      .rows_per_block = rows_per_block(model.problem.recordings[recording].time_s, pass->channels, block_s)};
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

// What is known beforehand of shared unknowns, as rows of their own: no law acts on them.
Reduced known_beforehand(const FittedModel& model, Eigen::Index laws) {
  const std::vector<Unknown>& unknowns = model.problem.shared;
  const Eigen::Index rows = std::ranges::count_if(unknowns, &Unknown::is_known);
  Reduced known{.shared = RowMatrix::Zero(rows, static_cast<Eigen::Index>(unknowns.size())),
                .laws = RowMatrix::Zero(rows, laws),
                .residual = Eigen::VectorXd(rows),
                .raw_norm = Eigen::VectorXd::Zero(laws),
                .rows_per_block = std::max<Eigen::Index>(rows, 1)};
  Eigen::Index row = 0;
  for (std::size_t k = 0; k < unknowns.size(); ++k) {
    if (!unknowns[k].is_known()) continue;
    known.shared(row, static_cast<Eigen::Index>(k)) = -1.0 / unknowns[k].prior_std;
    known.residual(row++) = unknowns[k].prior_residual(model.optimum.point.shared[k]);
  }
  return known;
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
                                        const std::vector<PassColumn>& columns, const ScreeningOptions& options) {
  using Part = std::optional<Result<Reduced>>;
  std::vector<Part> parts = in_parallel<Part>(model.problem.recordings.size(), options.threads, [&](std::size_t k) {
    return reduce(model, k, candidates, columns, options.block_s);
  });
  std::vector<Reduced> all;
  for (Part& part : parts) {
    if (!*part) return fail(part->error());
    all.push_back(std::move(**part));
  }
  return all;
}

// What one recording adds to the normal equations of the shared unknowns, S, and the laws, L:  S'S, S'L, S'r.
struct Normal {
  Eigen::MatrixXd gram, cross;
  Eigen::VectorXd right;
};

// And to what is left of laws and residual once the shared unknowns are taken off them.
struct Left {
  Eigen::MatrixXd gram, sums, grams;
};

Left without_shared(Reduced& part, const Normal& all, const std::vector<Variant>& variants) {
  if (part.shared.cols() > 0) {
    const Projection projection(part.shared, all.gram);
    part.laws.noalias() -= part.shared * projection.coefficients(all.cross);
    part.residual.noalias() -= part.shared * projection.coefficients(all.right);
  }
  Left left{.gram = Eigen::MatrixXd::Zero(part.laws.cols(), part.laws.cols()),
            .sums = block_sums(part.laws, part.residual, part.rows_per_block),
            .grams = block_grams(part.laws, variants, part.rows_per_block)};
  left.gram.selfadjointView<Eigen::Lower>().rankUpdate(part.laws.transpose());
  part.laws.resize(0, 0);
  return left;
}

// Of all recordings, whose laws are laid out in columns of all; `recordings` of the parts are such, the last may be what
// is known beforehand.
Normal normal_equations_of(std::vector<Reduced>& parts, std::size_t recordings, const Layout& layout, int threads) {
  const std::vector<Normal> normals = in_parallel<Normal>(parts.size(), threads, [&](std::size_t k) {
    Reduced& part = parts[k];
    part.laws = k < recordings ? spread(part.laws, layout, k) : RowMatrix::Zero(part.laws.rows(), layout.size);
    return Normal{.gram = part.shared.transpose() * part.shared,
                  .cross = part.shared.transpose() * part.laws,
                  .right = part.shared.transpose() * part.residual};
  });
  Normal all = normals.front();
  for (std::size_t k = 1; k < normals.size(); ++k) {
    all.gram += normals[k].gram;
    all.cross += normals[k].cross;
    all.right += normals[k].right;
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
  Result<std::vector<Reduced>> parts = reduce_all(model, screening.candidates, columns, options);
  if (!parts) return fail(parts.error());
  const std::size_t recordings = parts->size();
  if (std::ranges::any_of(model.problem.shared, &Unknown::is_known))
    parts->push_back(known_beforehand(model, static_cast<Eigen::Index>(columns.size())));

  const auto shared = static_cast<Eigen::Index>(model.problem.shared.size());
  const Normal all = normal_equations_of(*parts, recordings, layout, options.threads);
  Eigen::VectorXd raw_norm = Eigen::VectorXd::Zero(layout.size);
  for (std::size_t k = 0; k < parts->size(); ++k)
    for (std::size_t c = 0; c < columns.size(); ++c)
      for (std::size_t j = 0; j < layout.of_pass[c].size(); ++j)
        if (layout.of_pass[c].size() == 1 || j == k)
          raw_norm(layout.of_pass[c][j]) += (*parts)[k].raw_norm(static_cast<Eigen::Index>(c));
  std::vector<Left> left = in_parallel<Left>(parts->size(), options.threads, [&](std::size_t k) {
    return without_shared((*parts)[k], all, screening.variants);
  });
  screening.gram = Eigen::MatrixXd::Zero(layout.size, layout.size);
  std::vector<Eigen::MatrixXd> sums, grams;
  Eigen::Index blocks = 0;
  for (Left& part : left) {
    screening.gram += part.gram;
    blocks += part.sums.rows();
    sums.push_back(std::move(part.sums));
    grams.push_back(std::move(part.grams));
  }
  screening.gram.triangularView<Eigen::StrictlyUpper>() = screening.gram.transpose();
  screening.block_scores = stacked(sums, blocks);
  screening.gradient = screening.block_scores.colwise().sum();
  if (shared > 0) find_leakage_shifts(screening, model, all.gram, all.cross);
  evaluate(screening, raw_norm, stacked(grams, blocks),
           resolution_of(data, model.problem.recordings.front().simulation->plant()));
  calibrate(screening, options);
  return screening;
}

}  // namespace sealwatch::mismatch

#include "services/common/mismatch/screening.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "services/common/core/in_parallel.hpp"
#include "services/common/dense/row_products.hpp"
#include "services/common/mismatch/linear_algebra.hpp"
#include "services/common/mismatch/orders.hpp"
#include "services/common/mismatch/screening_scores.hpp"
#include "services/common/mismatch/sensitivity_pass.hpp"
#include "services/common/mismatch/windows.hpp"

namespace sealwatch::mismatch {
namespace {

Eigen::Index rows_per_block(const std::vector<double>& time_s, Eigen::Index channels, double block_s) {
  const double rate = static_cast<double>(time_s.size()) / (time_s.back() - time_s.front());
  return std::max<Eigen::Index>(1, static_cast<Eigen::Index>(block_s * rate)) * channels;
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

// One recording: products of its free columns Z, its residual r and its laws' columns L, where Z = Q R with about
// orthonormal Q. All that is asked of what is left of r and L, once combinations of Z are taken off them, comes from
// these products: no column is kept. Z itself would not do, since its columns may nearly depend on each other, and
// large multiples of them would leave rounding. Columns of L are those of all recordings (Layout); other recordings'
// are zero.
struct Products {
  std::vector<std::size_t> not_finite;  ///< candidates without a finite value somewhere: nothing else is here then
  Eigen::Index free = 0;                ///< columns of Q
  Eigen::MatrixXd all;                  ///< [Q r L]'[Q r L]
  std::vector<Eigen::MatrixXd> block;   ///< its rows of Q and r, per block of time
  Eigen::MatrixXd variant;              ///< L_b'L_b of each variant, its entries one after the other; blocks x entries
  Eigen::MatrixXd shared_in_q, own_in_q;   ///< R
  Eigen::MatrixXd shared_left, own_taken;  ///< in Q: shared columns without own ones; what own ones take off [r L]
  Eigen::MatrixXd own_for_shared, own_for_laws;  ///< own unknowns that do what they can of each shared one, of [r L]
};

Eigen::Index entries_of(const std::vector<Variant>& variants) {
  Eigen::Index entries = 0;
  for (const Variant& variant : variants)
    entries += static_cast<Eigen::Index>(variant.columns.size() * variant.columns.size());
  return entries;
}

// f(j, k) for each entry of each variant.
template <class F>
void for_each_entry(const std::vector<Variant>& variants, const F& f) {
  for (const Variant& variant : variants)
    for (const Eigen::Index j : variant.columns)
      for (const Eigen::Index k : variant.columns) f(j, k);
}

std::vector<Eigen::Index> held_unknowns(const FittedModel& model) {
  std::vector<Eigen::Index> held;
  for (std::size_t k = 0; k < model.problem.shared.size(); ++k)
    if (at_bound(model.problem.shared[k], model.optimum.point.shared[k])) held.push_back(static_cast<Eigen::Index>(k));
  return held;
}

// Z becomes Q; R.
Eigen::MatrixXd orthonormalise(RowMatrix& z) {
  const Eigen::MatrixXd gram = dense::gram_of_rows(z);
  const Eigen::VectorXd scale = gram.diagonal().cwiseMax(1e-300).cwiseSqrt();
  Eigen::MatrixXd scaled = scale.cwiseInverse().asDiagonal() * gram * scale.cwiseInverse().asDiagonal();
  scaled.diagonal().array() += kRidge;
  const Eigen::MatrixXd upper = scaled.llt().matrixU();
  z = z * scale.cwiseInverse().asDiagonal();
  upper.triangularView<Eigen::Upper>().solveInPlace<Eigen::OnTheRight>(z);
  return upper * scale.asDiagonal();
}

// The products of one recording, block by block of time.
void multiply(const Pass& pass, const RowMatrix& q, const RowMatrix& held, const std::vector<Eigen::Index>& place,
              Eigen::Index block_rows, const std::vector<Variant>& variants, Products& products) {
  constexpr Eigen::Index kAtOnce = 128;  // rows: their panels stay in the nearest cache
  const Eigen::Index laws = static_cast<Eigen::Index>(place.size()) - q.cols() - 1 - held.cols(), rows = q.rows(),
                     blocks = std::max<Eigen::Index>(1, rows / block_rows), size = products.all.rows();
  products.variant.resize(blocks, entries_of(variants));
  dense::RowBlock together(std::ssize(place), kAtOnce);
  std::vector<double> row(place.size());
  for (Eigen::Index b = 0; b < blocks; ++b) {
    const Eigen::Index end = b + 1 == blocks ? rows : (b + 1) * block_rows;
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(std::ssize(place), std::ssize(place));
    for (Eigen::Index at = b * block_rows; at < end; ++at) {
      std::copy_n(q.data() + at * q.cols(), q.cols(), row.data());
      row[static_cast<std::size_t>(q.cols())] = pass.residual(at);
      pass.law_row(at, laws, row.data() + q.cols() + 1);
      std::copy_n(held.data() + at * held.cols(), held.cols(), row.data() + q.cols() + 1 + laws);
      together.add(row.data());
      if (!together.full() && at + 1 < end) continue;
      together.add_gram_to(gram);
      together.clear();
    }
    Eigen::MatrixXd wide = Eigen::MatrixXd::Zero(size, size);
    wide(place, place) = gram;
    Eigen::Index entry = 0;
    const Eigen::Index first = q.cols() + 1;
    for_each_entry(variants,
                   [&](Eigen::Index j, Eigen::Index k) { products.variant(b, entry++) = wide(first + j, first + k); });
    products.block.emplace_back(wide.topRows(first));
    products.all += wide;
  }
}

Result<Products> products_of(const FittedModel& model, std::size_t recording, const std::vector<Candidate>& candidates,
                             const std::vector<PassColumn>& columns, const Layout& layout,
                             const std::vector<Variant>& variants, double block_s) {
  Result<Pass> pass = sensitivity_pass(model, recording, candidates, columns);
  if (!pass) return fail(pass.error());
  const auto shared = static_cast<Eigen::Index>(model.problem.shared.size());
  Products products;
  products.not_finite = pass->not_finite;
  if (!products.not_finite.empty()) return products;
  RowMatrix q = std::move(pass->free);
  const std::vector<Eigen::Index> at_end = held_unknowns(model);
  const RowMatrix held = q(Eigen::all, at_end);
  q(Eigen::all, at_end).setZero();  // what is held swallows nothing
  const Eigen::MatrixXd r = orthonormalise(q);
  const Eigen::Index first_held = q.cols() + 1 + layout.size, size = first_held + held.cols();
  products.free = q.cols();
  products.all = Eigen::MatrixXd::Zero(size, size);
  products.shared_in_q = r.leftCols(shared);
  products.own_in_q = r.rightCols(q.cols() - shared);
  std::vector<Eigen::Index> place;
  for (Eigen::Index k = 0; k <= q.cols(); ++k) place.push_back(k);
  for (const auto& of : layout.of_pass) place.push_back(q.cols() + 1 + (of.size() == 1 ? of.front() : of[recording]));
  for (Eigen::Index k = first_held; k < size; ++k) place.push_back(k);
  multiply(*pass, q, held, place, rows_per_block(model.problem.recordings[recording].time_s, pass->channels, block_s),
           variants, products);
  return products;
}

// Recordings whose passes are kept at once: those of one long test would take as much memory as all else.
int passes_at_once(const FittedModel& model, std::size_t columns, int threads) {
  constexpr double kMost_bytes = 256e6;
  double largest_bytes = 1.0;
  for (const PemRecording& part : model.problem.recordings)
    largest_bytes = std::max(largest_bytes, static_cast<double>(part.simulation->recorded().size() * sizeof(double)) *
                                                static_cast<double>(columns));
  return std::clamp(static_cast<int>(kMost_bytes / largest_bytes), 1, threads);
}

// What one recording adds to the normal equations of the shared unknowns, S, and [r L], its own unknowns taken off.
struct Normal {
  Eigen::MatrixXd gram, cross;
};

Normal without_own(Products& products) {
  const Eigen::MatrixXd inner = products.all.topLeftCorner(products.free, products.free),
                        outer = products.all.topRows(products.free).rightCols(products.all.cols() - products.free);
  products.shared_left = products.shared_in_q;
  products.own_taken = Eigen::MatrixXd::Zero(products.free, outer.cols());
  if (const Eigen::MatrixXd& own = products.own_in_q; own.cols() > 0) {
    const NormalMatrix normal(own.transpose() * inner * own);
    products.own_for_shared = normal.solve(own.transpose() * inner * products.shared_in_q);
    products.own_for_laws = normal.solve(own.transpose() * outer);
    products.shared_left -= own * products.own_for_shared;
    products.own_taken = own * products.own_for_laws;
  }
  const Eigen::MatrixXd left = inner * products.shared_left;
  return {.gram = products.shared_left.transpose() * left,
          .cross = products.shared_left.transpose() * outer - left.transpose() * products.own_taken};
}

// The own unknowns beside the shared ones' coefficients.
Eigen::MatrixXd own_like_law(const Products& products, const Eigen::MatrixXd& coefficients) {
  if (products.own_in_q.cols() == 0) return Eigen::MatrixXd::Zero(0, coefficients.cols() - 1);
  const Eigen::MatrixXd own = products.own_for_laws - products.own_for_shared * coefficients;
  return own.rightCols(own.cols() - 1);
}

// What is known beforehand of shared unknowns, as rows of their own, the residual last: no law acts on them. Columns are
// what the simulation changes by, residuals what it misses by, as those of the recordings (Pass).
RowMatrix known_beforehand(const FittedModel& model) {
  const std::vector<Unknown>& unknowns = model.problem.shared;
  const auto shared = static_cast<Eigen::Index>(unknowns.size());
  RowMatrix known = RowMatrix::Zero(std::ranges::count_if(unknowns, &Unknown::is_known), shared + 1);
  Eigen::Index row = 0;
  for (std::size_t k = 0; k < unknowns.size(); ++k) {
    if (!unknowns[k].is_known()) continue;
    known(row, static_cast<Eigen::Index>(k)) = 1.0 / unknowns[k].prior_std;
    known(row++, shared) = unknowns[k].prior_residual(model.optimum.point.shared[k]);
  }
  return known;
}

// What is left of laws and residual once all unknowns are taken off them.
struct Left {
  Eigen::MatrixXd gram;   ///< s~'s~
  Eigen::MatrixXd sums;   ///< s~_b' r_b per block
  Eigen::MatrixXd grams;  ///< s~_b' s~_b of each variant per block: what a law itself adds to its blocks' scores
};

// With T = Q M taken off [r L]:  (L - T_L)'(L - T_L) = L'L - (Q'L)'M_L - M_L'(Q'L - Q'Q M_L), and so in each block.
Left left_of(const Products& products, const Eigen::MatrixXd& coefficients, const std::vector<Variant>& variants) {
  const Eigen::Index free = products.free, laws = products.all.cols() - free - 1;
  const Eigen::MatrixXd taken = products.own_taken + products.shared_left * coefficients;
  const auto of_laws = taken.rightCols(laws);
  Left left{.gram = products.all.bottomRightCorner(laws, laws),
            .sums = Eigen::MatrixXd(std::ssize(products.block), laws),
            .grams = products.variant};
  const auto rest_of = [&](const auto& rows) -> Eigen::MatrixXd {
    return rows.topRows(free).rightCols(laws + 1) - rows.topLeftCorner(free, free) * taken;
  };
  left.gram.noalias() -= products.all.topRows(free).rightCols(laws).transpose() * of_laws;
  left.gram.noalias() -= of_laws.transpose() * rest_of(products.all).rightCols(laws);
  for (std::size_t b = 0; b < products.block.size(); ++b) {
    const Eigen::MatrixXd& rows = products.block[b];
    const auto across = rows.topRows(free).rightCols(laws);
    const Eigen::MatrixXd rest = rest_of(rows);
    const auto at = static_cast<Eigen::Index>(b);
    left.sums.row(at) =
        rows.row(free).tail(laws) - taken.col(0).transpose() * across - rest.col(0).transpose() * of_laws;
    Eigen::Index entry = 0;
    for_each_entry(variants, [&](Eigen::Index j, Eigen::Index k) {
      left.grams(at, entry++) -= across.col(j).dot(of_laws.col(k)) + of_laws.col(j).dot(rest.col(1 + k));
    });
  }
  return left;
}

Left left_of_known(const RowMatrix& known, const Eigen::MatrixXd& coefficients, const std::vector<Variant>& variants) {
  RowMatrix taken = -known.leftCols(known.cols() - 1) * coefficients;
  taken.col(0) += known.col(known.cols() - 1);
  const RowMatrix laws = taken.rightCols(taken.cols() - 1);
  Left left{.gram = laws.transpose() * laws,
            .sums = taken.col(0).transpose() * laws,
            .grams = Eigen::MatrixXd(1, entries_of(variants))};
  Eigen::Index entry = 0;
  for_each_entry(variants, [&](Eigen::Index j, Eigen::Index k) { left.grams(0, entry++) = left.gram(j, k); });
  return left;
}

// Laws of which nothing but rounding is left, as unknowns do all that they do, ask for nothing.
void leave_out_rounding(Screening& screening, const Eigen::VectorXd& raw_norm) {
  constexpr double kRounding = 1e-12;
  for (Eigen::Index k = 0; k < raw_norm.size(); ++k) {
    if (!(screening.gram(k, k) < kRounding * raw_norm(k))) continue;
    screening.gram.row(k).setZero();
    screening.gram.col(k).setZero();
    screening.gram(k, k) = kRounding * raw_norm(k);
    screening.block_scores.col(k).setZero();
  }
}

Eigen::MatrixXd stacked(const std::vector<Left>& parts, Eigen::MatrixXd Left::*what) {
  Eigen::Index rows = 0;
  for (const Left& part : parts) rows += (part.*what).rows();
  Eigen::MatrixXd all(rows, (parts.front().*what).cols());
  Eigen::Index at = 0;
  for (const Left& part : parts) {
    all.middleRows(at, (part.*what).rows()) = part.*what;
    at += (part.*what).rows();
  }
  return all;
}

using Parts = std::vector<std::optional<Result<Products>>>;

// Takes candidates without a finite value in some recording out of the screening; whether there were any.
bool leave_out_not_finite(const Parts& parts, Screening& screening) {
  std::vector<bool> finite(screening.candidates.size(), true);
  for (const auto& part : parts)
    for (const std::size_t candidate : (*part)->not_finite) finite[candidate] = false;
  std::vector<Candidate> asked;
  for (std::size_t k = 0; k < finite.size(); ++k)
    (finite[k] ? asked : screening.not_asked).push_back(std::move(screening.candidates[k]));
  screening.candidates = std::move(asked);
  return screening.candidates.size() < finite.size();
}

// The columns that are asked for, and where those of all recordings stand.
struct Asked {
  std::vector<PassColumn> columns;
  Layout layout;
};

Parts products_of_all(const FittedModel& model, const Screening& screening, const Asked& asked,
                      const ScreeningOptions& options) {
  const int threads = passes_at_once(model, asked.columns.size(), options.threads);
  return in_parallel<Parts::value_type>(model.problem.recordings.size(), threads, [&](std::size_t k) {
    return products_of(model, k, screening.candidates, asked.columns, asked.layout, screening.variants,
                       options.block_s);
  });
}

// All recordings together, all unknowns taken off.
struct Projected {
  Normal all;
  Eigen::MatrixXd coefficients;  ///< of the shared unknowns, by which [r L] are taken off
  Eigen::VectorXd raw_norm;
  std::vector<Left> left;  ///< per recording, and of what is known beforehand
};

Projected project(const FittedModel& model, Parts& parts, const Asked& asked, const Screening& screening, int threads) {
  const RowMatrix known = known_beforehand(model);
  const auto shared = static_cast<Eigen::Index>(model.problem.shared.size());
  const Eigen::Index size = asked.layout.size + std::ssize(held_unknowns(model));
  Projected projected{
      .all = {.gram = dense::gram_of_rows(known.leftCols(shared)), .cross = Eigen::MatrixXd::Zero(shared, size + 1)},
      .coefficients = Eigen::MatrixXd::Zero(shared, size + 1),
      .raw_norm = Eigen::VectorXd::Zero(size),
      .left = {}};
  projected.all.cross.col(0) = known.leftCols(shared).transpose() * known.col(shared);
  for (auto& part : parts) {
    const Normal normal = without_own(**part);
    projected.all.gram += normal.gram;
    projected.all.cross += normal.cross;
    projected.raw_norm += (*part)->all.diagonal().tail(size);
  }
  if (shared > 0) projected.coefficients = NormalMatrix(projected.all.gram).solve(projected.all.cross);
  projected.left = in_parallel<Left>(parts.size(), threads, [&](std::size_t k) {
    return left_of(**parts[k], projected.coefficients, screening.variants);
  });
  if (known.rows() > 0) projected.left.push_back(left_of_known(known, projected.coefficients, screening.variants));
  return projected;
}

// What the noise of measured inputs makes of U_b: the mean of some drawings. Zero where the simulation has no such
// input.
Eigen::MatrixXd feigned_scores(const FittedModel& model, const Data& data, const ScreeningOptions& options,
                               const Screening& screening, const Asked& asked) {
  constexpr std::uint64_t kDrawings = 4;
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(screening.block_scores.rows(), screening.block_scores.cols());
  if (data.of_inputs.empty()) return sum;
  double count = 0.0;
  for (std::uint64_t drawing = 0; drawing < kDrawings; ++drawing) {
    const auto feigned = feigned_by_inputs(model, data, options.seed + drawing);
    if (!feigned) continue;
    Parts parts = products_of_all(*feigned, screening, asked, options);
    const auto failed = [](const auto& part) { return !*part || !(*part)->not_finite.empty(); };
    if (std::ranges::any_of(parts, failed)) continue;
    sum += stacked(project(*feigned, parts, asked, screening, options.threads).left, &Left::sums)
               .leftCols(asked.layout.size);
    count += 1.0;
  }
  return count > 0.0 ? sum / count : sum;
}

// The held unknowns out of the products, where they stand behind the laws; `gram`: of both.
HeldUnknowns held_beside(const FittedModel& model, const Projected& projected, const Parts& parts,
                         const Eigen::MatrixXd& gram, Eigen::Index laws) {
  HeldUnknowns held{.unknown = held_unknowns(model), .least = {}, .most = {}, .gram = {}, .across = {}, .gradient = {}};
  const Eigen::Index count = std::ssize(held.unknown);
  held.least = held.most = Eigen::VectorXd::Zero(count);
  held.gram = gram.bottomRightCorner(count, count);
  held.across = gram.bottomLeftCorner(count, laws);
  held.gradient = stacked(projected.left, &Left::sums).rightCols(count).colwise().sum();
  held.shared_like = projected.coefficients.rightCols(count);
  for (const auto& part : parts) held.own_like.push_back(own_like_law(**part, projected.coefficients).rightCols(count));
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto place = static_cast<std::size_t>(held.unknown[static_cast<std::size_t>(k)]);
    const Unknown& unknown = model.problem.shared[place];
    const double at = model.optimum.point.shared[place];
    held.least(k) = std::min(0.0, unknown.to_unknown(unknown.min) - at);
    held.most(k) = std::max(0.0, unknown.to_unknown(unknown.max) - at);
    if (!unknown.is_known()) continue;
    held.gram(k, k) += 1.0 / (unknown.prior_std * unknown.prior_std);
    held.gradient(k) += unknown.prior_residual(at) / unknown.prior_std;
  }
  return held;
}

Result<Screening> screen_candidates(const FittedModel& model, const Data& data, const ScreeningOptions& options,
                                    Screening screening) {
  Asked asked{.columns = pass_columns(screening.candidates), .layout = {}};
  asked.layout = lay_out(asked.columns, data.samples.size());
  screening.variants = make_variants(asked.columns, asked.layout);
  screening.unit.resize(static_cast<std::size_t>(asked.layout.size));
  for (std::size_t k = 0; k < asked.columns.size(); ++k)
    for (const Eigen::Index index : asked.layout.of_pass[k])
      screening.unit[static_cast<std::size_t>(index)] = asked.columns[k].unit;
  Parts parts = products_of_all(model, screening, asked, options);
  for (const auto& part : parts)
    if (!*part) return fail(part->error());
  if (leave_out_not_finite(parts, screening))
    return screen_candidates(
        model, data, options,
        {.candidates = std::move(screening.candidates), .not_asked = std::move(screening.not_asked)});

  const Projected projected = project(model, parts, asked, screening, options.threads);
  const Eigen::Index size = asked.layout.size;
  screening.shared_like_law = projected.coefficients.middleCols(1, size);
  for (const auto& part : parts)
    screening.own_like_law.push_back(own_like_law(**part, projected.coefficients).leftCols(size));
  Eigen::MatrixXd gram = projected.left.front().gram;
  for (std::size_t k = 1; k < projected.left.size(); ++k) gram += projected.left[k].gram;
  gram.triangularView<Eigen::StrictlyUpper>() = gram.transpose();
  screening.gram = gram.topLeftCorner(size, size);
  screening.held = held_beside(model, projected, parts, gram, size);
  screening.block_scores = stacked(projected.left, &Left::sums).leftCols(size);
  screening.block_scores -= feigned_scores(model, data, options, screening, asked);
  leave_out_rounding(screening, projected.raw_norm.head(size));
  screening.gradient = screening.block_scores.colwise().sum();
  if (projected.all.gram.rows() > 0)
    find_leakage_shifts(screening, model, projected.all.gram, projected.all.cross.middleCols(1, size));
  screening.misfit = model.misfit - (model.optimum.converged ? 0.0 : 2.0 * model.optimum.promised);
  evaluate(screening, projected.raw_norm.head(size), stacked(projected.left, &Left::grams), model.residuals,
           resolution_of(data, model.problem.recordings.front().simulation->plant()));
  calibrate(screening, options);
  return screening;
}

}  // namespace

Result<Screening> screen(const FittedModel& model, const Data& data, const ScreeningOptions& options) {
  Screening screening{
      .candidates = find_candidates(*model.problem.recordings.front().simulation, model.asset.physics, options.laws)};
  if (data.are_parts)
    std::erase_if(screening.candidates,
                  [](const Candidate& candidate) { return candidate.law->kind == SiteKind::sensor_drift; });
  set_out_from_strongest_orders(screening.candidates, model, options.threads);
  return screen_candidates(model, data, options, std::move(screening));
}

Result<Screening> screen_laws(const FittedModel& model, std::vector<Candidate> laws, const Data& data,
                              const ScreeningOptions& options) {
  return screen_candidates(model, data, options, {.candidates = std::move(laws)});
}

}  // namespace sealwatch::mismatch

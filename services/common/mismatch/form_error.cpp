#include "services/common/mismatch/form_error.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "services/common/mismatch/candidates.hpp"
#include "services/common/mismatch/criterion.hpp"
#include "services/common/mismatch/linear_algebra.hpp"
#include "services/common/mismatch/screening.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kMostly = 0.5;  // of what the small law does alone
// A form may take up to a thousand times the noise, in the norm of all residuals: more is a direction that nothing shows.
constexpr double kFormPrior = 1e-6;

// g' (G + prior)^-1 g, columns of any size.
double together(const Screening& screening, const std::vector<Eigen::Index>& columns) {
  if (columns.empty()) return 0.0;
  const Eigen::MatrixXd gram = submatrix(screening.gram, columns);
  const Eigen::VectorXd scale = gram.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd scaled = dense::scaled(gram, scale);
  scaled.diagonal().array() += kFormPrior;
  return quadratic(scaled, scale.cwiseProduct(subvector(screening.gradient, columns)));
}

}  // namespace

std::vector<LawStart> more_than_form(const FittedModel& without, std::span<const Effect> large,
                                     std::vector<LawStart> small, const Data& data, const ExplainOptions& options) {
  if (small.empty()) return {};
  const auto is_of_large = [&](const Candidate& law) {
    return std::ranges::find(large, law.element, &Effect::element) != large.end();
  };
  std::vector<Candidate> laws;
  for (Candidate& law : find_candidates(*without.problem.recordings.front().simulation, {}, Laws::all)) {
    for (const LawStart& one : small) {
      if (law.law != one.effect.law || law.element != one.effect.element) continue;
      laws.push_back(law);
      laws.back().grid = {one.parameters};
    }
    if (is_of_large(law)) laws.push_back(std::move(law));
  }
  const auto screening =
      screen_laws(without, std::move(laws), data, {.draws = 1, .seed = options.seed, .threads = options.threads});
  if (!screening) return {};
  const auto columns_of = [&](const auto& is_asked) {
    std::vector<Eigen::Index> columns;
    for (const Variant& variant : screening->variants)
      if (is_asked(screening->candidates[variant.candidate]))
        columns.insert(columns.end(), variant.columns.begin(), variant.columns.end());
    return columns;
  };
  std::erase_if(small, [&](const LawStart& one) {
    std::vector<Eigen::Index> columns = columns_of([&](const Candidate& law) {
      return law.law == one.effect.law && law.element == one.effect.element && law.grid.front() == one.parameters;
    });
    const std::vector<Eigen::Index> forms = columns_of([&](const Candidate& law) {
      const bool is_the_same = law.law->id == one.effect.law->id && law.element == one.effect.element;
      return is_of_large(law) && !is_the_same;
    });
    const double alone = together(*screening, columns);
    columns.insert(columns.end(), forms.begin(), forms.end());
    const double beyond = together(*screening, columns) - together(*screening, forms);
    return !(beyond > kWorthAnother * dispersion(without) && beyond > kMostly * alone);
  });
  return small;
}

}  // namespace sealwatch::mismatch

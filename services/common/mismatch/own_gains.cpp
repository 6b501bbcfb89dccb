#include "services/common/mismatch/own_gains.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "services/common/dense/row_products.hpp"
#include "services/common/mismatch/linear_algebra.hpp"

namespace sealwatch::mismatch {
namespace {

// J'J and J'r of one recording by the shared unknowns, its own projected off.
struct NormalOfRecording {
  Eigen::MatrixXd information;
  Eigen::VectorXd score;
};

NormalOfRecording normal_of(const Linearisation& at, Eigen::Index shared) {
  RowMatrix both(at.jacobian.rows(), shared + 1);
  both << at.jacobian.leftCols(shared), at.residual;
  const RowMatrix own = at.jacobian.rightCols(at.jacobian.cols() - shared);
  Projection(own).remove_from(both);
  const Eigen::MatrixXd gram = dense::gram_of_rows(both);
  return {.information = gram.topLeftCorner(shared, shared), .score = gram.col(shared).head(shared)};
}

// Sums over the recordings, each of which has column `split` in a place of its own: its own first, then the others'
// behind the shared ones. -1: none has.
class Sums {
 public:
  Sums(Eigen::Index shared, Eigen::Index recordings, Eigen::Index split) : split_(split), shared_(shared) {
    const Eigen::Index all = split < 0 ? shared : shared + recordings - 1;
    information_ = Eigen::MatrixXd::Zero(all, all);
    score_ = Eigen::VectorXd::Zero(all);
  }

  void add(const NormalOfRecording& of, Eigen::Index recording) {
    const auto place = [&](Eigen::Index k) { return k == split_ && recording > 0 ? shared_ + recording - 1 : k; };
    for (Eigen::Index row = 0; row < shared_; ++row) {
      score_(place(row)) += of.score(row);
      for (Eigen::Index col = 0; col < shared_; ++col) information_(place(row), place(col)) += of.information(row, col);
    }
  }
  void add_known(Eigen::Index k, double residual, double slope) {
    information_(k, k) += slope * slope;
    score_(k) += slope * residual;
  }
  void hold(Eigen::Index k) {
    information_.row(k).setZero();
    information_.col(k).setZero();
    score_(k) = 0.0;
    information_(k, k) = 1.0;
  }
  [[nodiscard]] double gain() const { return score_.dot(NormalMatrix(information_).solve(score_).col(0)); }

 private:
  Eigen::Index split_, shared_;
  Eigen::MatrixXd information_;
  Eigen::VectorXd score_;
};

double gain_with(const FittedModel& model, const std::vector<NormalOfRecording>& normals, Eigen::Index split) {
  const auto shared = std::ssize(model.problem.shared);
  Sums sums(shared, std::ssize(normals), split);
  for (std::size_t k = 0; k < normals.size(); ++k) sums.add(normals[k], static_cast<Eigen::Index>(k));
  for (Eigen::Index k = 0; k < shared; ++k) {
    const Unknown& unknown = model.problem.shared[static_cast<std::size_t>(k)];
    const double at = model.optimum.point.shared[static_cast<std::size_t>(k)];
    if (unknown.is_known()) sums.add_known(k, unknown.prior_residual(at), -1.0 / unknown.prior_std);
    if (k != split && at_bound(unknown, at)) sums.hold(k);
  }
  return sums.gain();
}

}  // namespace

std::vector<OwnGain> gains_of_own_values(const FittedModel& model, std::span<const std::string> parameters) {
  std::vector<NormalOfRecording> normals;
  for (std::size_t k = 0; k < model.optimum.at_optimum.size(); ++k) {
    std::optional<Linearisation> anew;
    const Linearisation& at = linearised(model, k, anew);
    if (at.jacobian.size() == 0) return {};
    normals.push_back(normal_of(at, std::ssize(model.problem.shared)));
  }
  const double in_common = gain_with(model, normals, -1);  // of a search that has not quite ended
  std::vector<OwnGain> gains;
  for (std::size_t k = 0; k < model.problem.shared.size(); ++k) {
    const Unknown& unknown = model.problem.shared[k];
    const bool asked = std::ranges::find(parameters, unknown.name) != parameters.end();
    if (!asked || unknown.is_known() || unknown.group >= 0) continue;
    gains.push_back({unknown.name, gain_with(model, normals, static_cast<Eigen::Index>(k)) - in_common});
  }
  std::ranges::stable_sort(gains, std::greater<>(), &OwnGain::gain);
  return gains;
}

}  // namespace sealwatch::mismatch

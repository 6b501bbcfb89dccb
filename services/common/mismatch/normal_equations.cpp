#include "services/common/mismatch/normal_equations.hpp"

#include <optional>

#include "services/common/dense/row_products.hpp"

namespace sealwatch::mismatch {

NormalEquations normal_equations(const FittedModel& model) {
  const auto shared = static_cast<Eigen::Index>(model.problem.shared.size());
  Eigen::Index unknowns = shared;
  for (const PemRecording& part : model.problem.recordings) unknowns += static_cast<Eigen::Index>(part.own.size());
  NormalEquations all{.gram = Eigen::MatrixXd::Zero(unknowns, unknowns), .gradient = Eigen::VectorXd::Zero(unknowns)};
  Eigen::Index own = shared;
  for (std::size_t k = 0; k < model.optimum.at_optimum.size(); ++k) {
    std::optional<Linearisation> anew;
    const Linearisation& at = linearised(model, k, anew);
    if (at.jacobian.size() == 0) {
      own += static_cast<Eigen::Index>(model.problem.recordings[k].own.size());
      continue;
    }
    std::vector<Eigen::Index> place(static_cast<std::size_t>(at.jacobian.cols()));
    for (std::size_t j = 0; j < place.size(); ++j) {
      const auto column = static_cast<Eigen::Index>(j);
      place[j] = column < shared ? column : own + column - shared;
    }
    all.gram(place, place) += dense::gram_of_rows(at.jacobian);
    all.gradient(place) += at.jacobian.transpose() * at.residual;
    own += static_cast<Eigen::Index>(model.problem.recordings[k].own.size());
  }
  return all;
}

}  // namespace sealwatch::mismatch

#include "services/common/estimation/pem_costs.hpp"

#include <algorithm>

#include "services/common/core/in_parallel.hpp"

namespace sealwatch {
namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

}  // namespace

RecordingCost::RecordingCost(const PemProblem& problem, std::size_t recording, const std::atomic<bool>& failed)
    : problem_(problem), recording_(recording), point_failed_(failed) {
  shared_.resize(problem.shared.size());
  own_.resize(problem.recordings[recording].own.size());
  set_num_residuals(static_cast<int>(shared_.size() + own_.size()) + 1);
  if (!shared_.empty()) mutable_parameter_block_sizes()->push_back(static_cast<int>(shared_.size()));
  if (!own_.empty()) mutable_parameter_block_sizes()->push_back(static_cast<int>(own_.size()));
}

bool RecordingCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  if (point_failed_ ||
      !update(shared_.empty() ? nullptr : parameters[0], own_.empty() ? nullptr : parameters[shared_.empty() ? 0 : 1]))
    return false;
  const auto n = static_cast<Eigen::Index>(shared_.size() + own_.size());
  Eigen::Map<Eigen::VectorXd>(residuals, n + 1) = compressed_.col(n);
  if (jacobians == nullptr) return true;
  const auto shared = static_cast<Eigen::Index>(shared_.size()), own = static_cast<Eigen::Index>(own_.size());
  std::size_t block = 0;
  if (shared > 0 && jacobians[block++] != nullptr)
    Eigen::Map<Matrix>(jacobians[0], n + 1, shared) = compressed_.leftCols(shared);
  if (own > 0 && jacobians[block] != nullptr)
    Eigen::Map<Matrix>(jacobians[block], n + 1, own) = compressed_.middleCols(shared, own);
  return true;
}

void RecordingCost::remember(const std::vector<double>& shared, const std::vector<double>& own,
                             Linearisation linearisation) {
  shared_ = shared;
  own_ = own;
  linearisation_ = std::move(linearisation);
  compressed_ = compress(linearisation_);
  known_ = true;
  if (!has_kept()) return;
  kept_ = kept_derivatives(problem_, linearisation_);
  linearisation_.jacobian = not_known_jacobian(problem_, linearisation_.jacobian);
}

Result<Linearisation> RecordingCost::take_linearisation(const std::vector<double>& shared,
                                                        const std::vector<double>& own) const {
  if (!known_ || shared != shared_ || own != own_) return linearise(problem_, recording_, shared, own);
  known_ = false;
  if (has_kept()) linearisation_.jacobian = whole_jacobian(problem_, linearisation_.jacobian, kept_);
  return std::move(linearisation_);
}

bool RecordingCost::update(const double* shared, const double* own, bool may_keep) const {
  const bool same = std::equal(shared_.begin(), shared_.end(), shared) && std::equal(own_.begin(), own_.end(), own);
  if (same && known_ && (may_keep || !has_kept())) return true;
  if (known_ && !has_kept() && may_keep) kept_ = kept_derivatives(problem_, linearisation_);
  std::copy_n(shared, shared_.size(), shared_.begin());
  std::copy_n(own, own_.size(), own_.begin());
  const bool leaves = sets_out_;
  if (leaves) from_ = std::move(linearisation_);
  const bool keep = may_keep && kept_.any();
  Result<Linearisation> result =
      linearise(problem_, recording_, shared_, own_, keep ? Derivatives::by_what_is_not_known : Derivatives::by_all);
  if (!result) {
    if (leaves) linearisation_ = std::move(from_);
    known_ = known_ && same;  // with what was kept
    return false;
  }
  known_ = true;
  sets_out_ = false;
  linearisation_ = std::move(*result);
  linearisation_.has_kept = keep;
  compressed_ = keep ? compress(problem_, linearisation_, kept_) : compress(linearisation_);
  return true;
}

Bend RecordingCost::bend(const Eigen::VectorXd& step) const {
  if (sets_out_) return {.slope = Eigen::VectorXd::Zero(step.size())};  // of this recording nothing moved
  const Eigen::VectorXd a = linearisation_.residual - from_.residual - jacobian_times(problem_, from_, kept_, step);
  return {.slope = jacobian_transposed_times(problem_, from_, kept_, a),
          .with_residual = from_.residual.dot(a),
          .square = a.squaredNorm()};
}

PriorCost::PriorCost(const std::vector<Unknown>& unknowns) : unknowns_(unknowns) {
  set_num_residuals(static_cast<int>(std::ranges::count_if(unknowns, &Unknown::is_known)));
  mutable_parameter_block_sizes()->push_back(static_cast<int>(unknowns.size()));
}

bool PriorCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  Eigen::Index row = 0;
  const auto columns = static_cast<Eigen::Index>(unknowns_.size());
  double* jacobian = jacobians == nullptr ? nullptr : jacobians[0];
  if (jacobian != nullptr) Eigen::Map<Matrix>(jacobian, num_residuals(), columns).setZero();
  for (Eigen::Index k = 0; k < columns; ++k) {
    const Unknown& unknown = unknowns_[static_cast<std::size_t>(k)];
    if (!unknown.is_known()) continue;
    residuals[row] = unknown.prior_residual(parameters[0][k]);
    if (jacobian != nullptr) jacobian[row * columns + k] = -1.0 / unknown.prior_std;
    ++row;
  }
  return true;
}

void SideBySide::PrepareForEvaluation(bool /*evaluate_jacobians*/, bool new_evaluation_point) {
  if (new_evaluation_point) evaluate(false);
}

void SideBySide::evaluate(bool may_keep) {
  failed_ = false;
  in_parallel<char>(costs_.size(), threads_, [&](std::size_t k) {
    if (!failed_ && !costs_[k]->update(point_.shared.data(), point_.own[k].data(), may_keep)) failed_ = true;
    return char{};
  });
}

}  // namespace sealwatch

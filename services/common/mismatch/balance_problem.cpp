#include "services/common/mismatch/balance_problem.hpp"

#include <algorithm>
#include <cmath>

#include "sealwatch/model/physics.hpp"
#include "services/common/dense/dense.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kOfMean = 1.2533;    // standard deviation over mean size, of normal errors
constexpr double kLeastSize = 0.1;    // standard deviations, from which a residual weighs by its size
constexpr double kDifference = 1e-3;  // of an unknown, for its derivative
constexpr double kLongestStep = 2.0;  // of a logarithm
constexpr double kPull = 1e-9;        // on unseen directions
constexpr double kResolved = 0.02;    // change of the loss that ends a search

template <class Asset>
auto term_of(Asset& asset, const BalanceUnknown& unknown) {
  for (auto& term : asset.physics)
    if (term.id == unknown.law->id && term.element == unknown.element && term.parameters.contains(unknown.name))
      return &term;
  return static_cast<decltype(asset.physics.data())>(nullptr);
}

double stepped(const BalanceUnknown& unknown, double value, double step) {
  if (unknown.logarithmic)
    return std::clamp(value * std::exp(std::clamp(step, -kLongestStep, kLongestStep)), unknown.min, unknown.max);
  return std::clamp(value + unknown.unit * step, unknown.min, unknown.max);
}

}  // namespace

double value_of(const BalanceModel& model, const BalanceUnknown& unknown) {
  if (unknown.element.empty()) return model.load_factor[unknown.recording];
  if (unknown.law == nullptr) return model.asset.parameters.at(unknown.name).value;
  const PhysicsTerm* term = term_of(model.asset, unknown);
  return term == nullptr ? 0.0 : term->parameters.at(unknown.name).value;
}

void set_value(BalanceModel& model, const BalanceUnknown& unknown, double value) {
  if (unknown.element.empty())
    model.load_factor[unknown.recording] = value;
  else if (unknown.law == nullptr)
    model.asset.parameters.at(unknown.name).value = value;
  else
    term_of(model.asset, unknown)->parameters.at(unknown.name).value = value;
}

bool at_bound(const BalanceModel& model, const BalanceUnknown& unknown) {
  const double value = value_of(model, unknown), near = 1e-3 * (unknown.max - unknown.min);
  return unknown.logarithmic ? value < unknown.min * 1.001 || value > unknown.max * 0.999
                             : value - unknown.min < std::min(near, 1e-3 * unknown.unit) || unknown.max - value < near;
}

void put_back(BalanceModel& model, const AssetConfig& datasheet, const BalanceUnknown& what) {
  if (what.law == nullptr)
    set_value(model, what, datasheet.parameters.at(what.name).value);
  else
    std::erase_if(model.asset.physics, [&](const PhysicsTerm& term) {
      return term.id == what.law->id && term.element == what.element && term.parameters.contains(what.name);
    });
}

BalanceErrors errors_of(const SwitchedBalances::Residuals& residuals) {
  BalanceErrors errors;
  for (std::size_t b = 0; b < residuals.size(); ++b) {
    const Eigen::VectorXd& r = residuals[b];
    if (r.size() < 3) continue;
    errors.sigma[b] = std::max(kOfMean * r.cwiseAbs().mean(), 1e-300);
    errors.blocks[b] = static_cast<double>(r.size()) / kCorrelatedBlocks;
  }
  return errors;
}

double balance_loss(const SwitchedBalances::Residuals& residuals) {
  const BalanceErrors errors = errors_of(residuals);
  double sum = 0.0;
  for (std::size_t b = 0; b < residuals.size(); ++b)
    if (errors.sigma[b] > 0.0) sum += static_cast<double>(residuals[b].size()) * std::log(errors.sigma[b]);
  return sum;
}

StackedBalances stack(const SwitchedBalances::Residuals& residuals, const BalanceErrors& errors) {
  Eigen::Index rows = 0, at = 0;
  for (const Eigen::VectorXd& r : residuals) rows += r.size();
  StackedBalances stacked{Eigen::VectorXd(rows), Eigen::VectorXd(rows)};
  for (std::size_t b = 0; b < residuals.size(); ++b)
    for (Eigen::Index k = 0; k < residuals[b].size(); ++k, ++at) {
      stacked.residual(at) = residuals[b](k) / std::max(errors.sigma[b], 1e-300);
      stacked.weight(at) = 1.0 / std::max(std::abs(stacked.residual(at)), kLeastSize);
    }
  return stacked;
}

Eigen::VectorXd BalanceProblem::column(const BalanceModel& model, const BalanceUnknown& unknown,
                                       const StackedBalances& here, const BalanceErrors& errors) const {
  BalanceModel moved = model;
  const double value = value_of(moved, unknown);
  double step = kDifference;
  if (stepped(unknown, value, step) == value) step = -step;
  set_value(moved, unknown, stepped(unknown, value, step));
  return (stack(balances->residuals(moved), errors).residual - here.residual) / step;
}

Eigen::MatrixXd BalanceProblem::jacobian(const BalanceModel& model, const StackedBalances& here,
                                         const BalanceErrors& errors) const {
  Eigen::MatrixXd all(here.residual.size(), static_cast<Eigen::Index>(unknowns.size()));
  for (std::size_t k = 0; k < unknowns.size(); ++k)
    all.col(static_cast<Eigen::Index>(k)) = column(model, unknowns[k], here, errors);
  return all;
}

Eigen::MatrixXd BalanceProblem::normal(const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& weight) {
  Eigen::MatrixXd matrix = dense::transposed_product(jacobian, weight.asDiagonal() * jacobian);
  matrix.diagonal().array() += kPull;
  return matrix;
}

void BalanceProblem::fit(BalanceModel& model, int iterations) const {
  double damping = 1e-3;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    const SwitchedBalances::Residuals residuals = balances->residuals(model);
    const BalanceErrors errors = errors_of(residuals);
    const StackedBalances here = stack(residuals, errors);
    const Eigen::MatrixXd j = jacobian(model, here, errors);
    const Eigen::MatrixXd matrix = normal(j, here.weight);
    const Eigen::VectorXd gradient = j.transpose() * here.weight.cwiseProduct(here.residual);
    const double before = balance_loss(residuals);
    double after = before;
    for (int attempt = 0; attempt < 8 && !(after < before); ++attempt) {
      Eigen::MatrixXd damped = matrix;
      damped.diagonal() *= 1.0 + damping;
      BalanceModel moved = model;
      move(moved, dense::Symmetric(damped).solve(gradient));
      after = balance_loss(balances->residuals(moved));
      damping *= after < before ? 0.2 : 10.0;
      if (after < before) model = std::move(moved);
    }
    if (!(after < before - kResolved)) return;
  }
}

void BalanceProblem::move(BalanceModel& model, const Eigen::VectorXd& step) const {
  for (std::size_t k = 0; k < unknowns.size(); ++k)
    set_value(model, unknowns[k],
              stepped(unknowns[k], value_of(model, unknowns[k]), -step(static_cast<Eigen::Index>(k))));
}

BalanceErrors BalanceProblem::errors(const BalanceModel& model) const { return errors_of(balances->residuals(model)); }

}  // namespace sealwatch::mismatch

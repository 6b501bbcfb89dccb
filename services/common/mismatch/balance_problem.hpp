// The fit of given unknowns to the balances: each balance with an error level of its own, errors by their size and not
// by their square, so that blocks that no model follows (a jerk, a saturated supply) do not lead.
//
//   minimise sum_b N_b ln sigma_b,   sigma_b = 1.2533 mean |r_b|
//
// Levenberg and Marquardt on the reweighted squares; derivatives by differences.
#pragma once

#include "services/common/model/plants/eha_switched/mismatch/switched_balances.hpp"

namespace sealwatch::mismatch {

inline constexpr int kBalanceIterations = 40;
/// Blocks of 0.2 s that tell as much as one: what is left over lasts about a second.
inline constexpr double kCorrelatedBlocks = 5.0;

/// One unknown of the balances: a datasheet value, a law's strength, or a recording's load factor.
struct BalanceUnknown {
  std::string name = {};     ///< "Omega_M"; of a law the parameter's name, "F_c"
  std::string element = {};  ///< empty for a load
  const Law* law = nullptr;
  std::size_t recording = 0;  ///< of a load
  bool logarithmic = false;
  double unit = 1.0;  ///< of the search
  double min = 0.0, max = 0.0;
};

[[nodiscard]] double value_of(const BalanceModel& model, const BalanceUnknown& unknown);
void set_value(BalanceModel& model, const BalanceUnknown& unknown, double value);
/// What ends at a bound is not what is wrong: it stands in for something that the search has not found.
[[nodiscard]] bool at_bound(const BalanceModel& model, const BalanceUnknown& unknown);
/// What the model was without it: the datasheet's value, no such law.
void put_back(BalanceModel& model, const AssetConfig& datasheet, const BalanceUnknown& what);

/// Error level of each balance and the number of blocks that tell something new.
struct BalanceErrors {
  std::array<double, SwitchedBalances::kBalances.size()> sigma{}, blocks{};
};
[[nodiscard]] BalanceErrors errors_of(const SwitchedBalances::Residuals& residuals);
[[nodiscard]] double balance_loss(const SwitchedBalances::Residuals& residuals);

/// All balances in one vector, over their error levels; weights of the reweighted squares.
struct StackedBalances {
  Eigen::VectorXd residual, weight;
};
[[nodiscard]] StackedBalances stack(const SwitchedBalances::Residuals& residuals, const BalanceErrors& errors);

/// The fit over given unknowns, from where the model is.
struct BalanceProblem {
  const SwitchedBalances* balances = nullptr;
  std::vector<BalanceUnknown> unknowns;

  void fit(BalanceModel& model, int iterations) const;
  [[nodiscard]] BalanceErrors errors(const BalanceModel& model) const;
  [[nodiscard]] Eigen::VectorXd column(const BalanceModel& model, const BalanceUnknown& unknown,
                                       const StackedBalances& here, const BalanceErrors& errors) const;
  [[nodiscard]] Eigen::MatrixXd jacobian(const BalanceModel& model, const StackedBalances& here,
                                         const BalanceErrors& errors) const;
  /// Normal matrix; a very weak pull keeps unseen directions where they are.
  [[nodiscard]] static Eigen::MatrixXd normal(const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& weight);

 private:
  void move(BalanceModel& model, const Eigen::VectorXd& step) const;
};

}  // namespace sealwatch::mismatch

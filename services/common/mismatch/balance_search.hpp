// Which datasheet values and which absent laws the balances ask for (switched_balances.hpp), in order of weight.
//
// Every balance has its own error level, taken from what it leaves over, as no model of such a bench comes down to its
// sensors' noise:
//
//   criterion = sum_b (N_b / rho) 2 ln sigma_b + k ln(sum_b N_b / rho)
//   sigma_b = 1.2533 mean |r_b|, rho = 5: what is left over lasts about five blocks
//
// Greedy: all datasheet values and all laws at usual shape are tried on the linearised balances, the best of them
// refitted together with all that was found before (balance_problem.hpp), and the best is kept while it
// improves the criterion by 12; of laws that are not decisively worse, the one that acts in most places. What is not
// needed any more is taken out again. Laws keep their bounds, datasheet values stay within a tenth to ten times the
// sheet's. The asset's own free parameters and the recordings' loads are free throughout.
#pragma once

#include <string>
#include <vector>

#include "services/common/mismatch/balance_problem.hpp"

namespace sealwatch::mismatch {

/// Something that is off: with its weight, the rise of the criterion when it is put back.
struct BalanceFinding {
  BalanceUnknown what;
  double value = 0.0, std_error = 0.0;
  bool at_bound = false;
  double datasheet = 0.0;  ///< of a datasheet value
  double weight = 0.0;
  std::vector<BalanceFinding> alternatives;  ///< others in its place, by how much worse the criterion is (weight)
  BalanceModel without;                      ///< the fit with this one put back
};

struct BalanceParameter {
  std::string name;
  double before = 0.0, before_std = 0.0, after = 0.0, after_std = 0.0;
};

struct BalanceFit {
  BalanceModel baseline;                          ///< the asset's own free parameters and the loads alone
  BalanceModel model;                             ///< with what was found
  std::vector<BalanceParameter> free;             ///< the asset's own free parameters
  std::vector<double> error_before, error_after;  ///< sigma_b, in the balance's unit
  std::vector<BalanceFinding> findings;           ///< heaviest first
  double criterion_before = 0.0, criterion_after = 0.0;
};

/// `maximum_laws`: beside any number of datasheet values up to eight.
[[nodiscard]] BalanceFit search_balances(const AssetConfig& asset, const PlantDescription& plant,
                                         const SwitchedBalances& balances, int maximum_laws, int threads);

/// The findings that are left of `found`, fitted anew to the same balances: values, errors and weights.
[[nodiscard]] BalanceFit refit_findings(const AssetConfig& asset, const PlantDescription& plant,
                                        const SwitchedBalances& balances, const BalanceFit& found, int threads);

/// The same findings fitted to other recordings of the asset.
[[nodiscard]] BalanceFit refit_balances(const AssetConfig& asset, const SwitchedBalances& balances,
                                        const BalanceFit& found);

/// What recordings that took no part leave over, their loads fitted: minus the logarithm of the likelihood, less is
/// better.
[[nodiscard]] double held_out_loss(const SwitchedBalances& balances, const BalanceModel& model);

}  // namespace sealwatch::mismatch

// Everything that could be off in the balances: datasheet values that are not free already, laws of the catalogue at
// their usual shape and no strength, and errors of sensors that another sensor checks.
#pragma once

#include <optional>

#include "services/common/mismatch/balance_problem.hpp"

namespace sealwatch::mismatch {

struct BalanceOption {
  BalanceUnknown unknown;
  std::optional<PhysicsTerm> term;
  std::ptrdiff_t places = 1;  ///< sites at which a law acts
};

[[nodiscard]] std::vector<BalanceOption> balance_options(const AssetConfig& asset, const PlantDescription& plant);

/// What is free from the start: the asset's own free parameters, then each recording's load.
[[nodiscard]] std::vector<BalanceUnknown> free_unknowns(const AssetConfig& asset, std::size_t recordings);

/// Whether both are forms of one law at one element.
[[nodiscard]] bool same_law(const BalanceUnknown& a, const BalanceUnknown& b);

}  // namespace sealwatch::mismatch

// What the balances found, in the explanation's terms.
#pragma once

#include <string>

#include "sealwatch/mismatch/explanation.hpp"
#include "services/common/mismatch/balance_search.hpp"

namespace sealwatch::mismatch {

/// Id of a datasheet value that is off: its element's equation is right, its number is not.
inline constexpr std::string_view kDatasheetValue = "datasheet_value";

[[nodiscard]] std::string finding_key(const BalanceFinding& finding);
/// "Omega_M of the winding is 0.055 V s/rad, not 0.086".
[[nodiscard]] std::string finding_in_words(const BalanceFinding& finding);
[[nodiscard]] FoundEffect effect_of(const BalanceFinding& finding, const PlantDescription& plant, double held_out_gain);
/// How much a balance leaves over, before and after.
[[nodiscard]] std::string balance_in_words(std::size_t balance, const BalanceFit& fit);
/// The seal's leakage resistance, or why it cannot be told.
[[nodiscard]] std::string leakage_in_words(const BalanceFit& fit);
[[nodiscard]] std::string gross_summary(const Explanation& explanation);

}  // namespace sealwatch::mismatch

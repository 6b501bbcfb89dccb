// Pieces of what messages say that lines and screens share.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sealwatch/message/topics.hpp"

namespace sealwatch::cli {

/// "URGENT"
[[nodiscard]] std::string upper(std::string_view text);
/// "most likely internal leakage (81 %)", "possibly sensor pressure A (30 %)", "no fault stands out".
[[nodiscard]] std::string fault_words(const std::vector<ProposedFault>& group);
/// "model_discrepancy/A-1 accepted by J. Silva ..."
[[nodiscard]] std::string acceptance_words(const ModelAcceptance& acceptance);

}  // namespace sealwatch::cli

// The reverse of report/explanation_json.hpp: what is read back shows that report.json holds all.
#pragma once

#include <string_view>

#include "sealwatch/core/result.hpp"
#include "sealwatch/mismatch/explanation.hpp"

namespace sealwatch::report {

/// What report.json holds, as an Explanation: all but the samples of the recordings and the explained asset. null reads
/// as NaN. An Error names the key that is missing or of the wrong kind.
[[nodiscard]] Result<mismatch::Explanation> explanation_from_json(std::string_view text);

}  // namespace sealwatch::report

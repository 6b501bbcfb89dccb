// report.json of `explain` (schema sealwatch.mismatch/1). docs/mismatch-report.md lists all keys with their units.
// Numbers that are not finite are written as null. The same explanation gives the same text.
#pragma once

#include <string>
#include <string_view>

#include "sealwatch/core/result.hpp"
#include "sealwatch/mismatch/explanation.hpp"

namespace sealwatch::report {

[[nodiscard]] std::string explanation_to_json(const mismatch::Explanation& explanation);

/// What report.json holds, as an Explanation: all but the samples of the recordings and the explained asset. null reads
/// as NaN. An Error names the key that is missing or of the wrong kind.
[[nodiscard]] Result<mismatch::Explanation> explanation_from_json(std::string_view text);

}  // namespace sealwatch::report

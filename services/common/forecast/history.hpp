// History of estimates from a CSV file, for `sealwatch forecast`.
//
//   time[iso8601],theta[1],theta_std[1]                     seal condition and its standard error
//   time[iso8601],R_CL[Pa s/m3],R_CL_std[Pa s/m3]           leakage resistance: needs the asset's seal resistances
//
// The standard-error column may be absent as a whole (then the scatter about the line alone tells the uncertainty), but
// not in single rows. Times must increase. Other columns are passed over, unless they are a slip of the pen away
// from one of these. Errors name file, row (the header is row 1)
// and column.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/core/result.hpp"
#include "sealwatch/forecast/condition_history.hpp"

namespace sealwatch::forecast {

/// Reads the file at `path`. `seal` turns R_CL into theta.
[[nodiscard]] Result<std::vector<ConditionSample>> read_history(const std::string& path,
                                                                const std::optional<ConditionSetting>& seal);

/// The same from text; `file` is what errors call it.
[[nodiscard]] Result<std::vector<ConditionSample>> parse_history(const std::string& text, const std::string& file,
                                                                 const std::optional<ConditionSetting>& seal);

}  // namespace sealwatch::forecast

// From the fits of one test to its leakage estimate: which fit counts, and whether it may take part in the forecast.
#pragma once

#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/message/health_assessment.hpp"
#include "sealwatch/message/prognostic_assessment.hpp"

namespace sealwatch::prognostic_assessment {

/// Takes R_CL from the first admissible fit, else from the first that has one (and says that it is left out). theta and
/// its standard error come from the asset's line through the seal resistances. The header is not filled.
///
/// A test is left out of the forecast, with the reason, when health assessment found it inadmissible, no fit is
/// admissible, R_CL is not positive, theta is not defined or less certain than `largest_condition_std`, or the event
/// time is unknown.
[[nodiscard]] LeakageEstimate judge_estimate(const AssetConfig& asset, const HealthReport& health,
                                             std::vector<FitReport> fits, double largest_condition_std);

}  // namespace sealwatch::prognostic_assessment

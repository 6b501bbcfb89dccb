// Prognosis asks for tests; the Master Control System decides.
#pragma once

#include "sealwatch/config/asset.hpp"
#include "sealwatch/message/prognostic_assessment.hpp"

namespace sealwatch::prognostic_assessment {

/// The request that follows a test with known event time: at once when the test could not be used, else one interval
/// later. The header is not filled.
[[nodiscard]] PstRequest next_test(const AssetConfig& asset, const LeakageEstimate& estimate);

}  // namespace sealwatch::prognostic_assessment

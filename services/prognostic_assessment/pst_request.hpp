// Prognosis asks for tests; the Master Control System decides.
#pragma once

#include "sealwatch/config/asset.hpp"
#include "sealwatch/message/prognostic_assessment.hpp"

namespace sealwatch::prognostic_assessment {

/// The request that follows a test with known event time: at once when the test could not be used, else one interval
/// later. The header is not filled.
[[nodiscard]] PstRequest next_test(const AssetConfig& asset, const LeakageEstimate& estimate);

/// The request that follows a replacement ("seal replaced on 2018-06-10"), in place of the one that rests on a test of
/// what was replaced: one interval after it. The header is not filled.
[[nodiscard]] PstRequest first_test(const AssetConfig& asset, UtcTime replaced, const std::string& what);

}  // namespace sealwatch::prognostic_assessment

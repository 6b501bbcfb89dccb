// The mismatch analysis behind the port of health assessment.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "sealwatch/mismatch/explain.hpp"
#include "sealwatch/port/explainer.hpp"

namespace sealwatch {

/// Writes an asset as an asset file's text.
using AssetWriter = std::function<std::string(const AssetConfig&)>;

/// The typed form of what was found.
[[nodiscard]] ModelDiscrepancy discrepancy_of(const mismatch::Explanation& explanation);

/// With the analysis' own seed: the same tests give the same answer, as long as the time limit does not cut it.
[[nodiscard]] std::shared_ptr<const Explainer> make_mismatch_explainer(AssetWriter write_asset,
                                                                       const mismatch::ExplainOptions& options = {});

}  // namespace sealwatch

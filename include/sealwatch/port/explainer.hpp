// Port through which health assessment reaches the mismatch analysis; implemented in services/common/mismatch, injected
// by main.
#pragma once

#include <span>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/core/recording.hpp"
#include "sealwatch/message/health_assessment.hpp"

namespace sealwatch {

class Explainer {
 public:
  virtual ~Explainer() = default;
  /// Verdict, location, physics and the explained model. What cannot be analysed comes back with analysed = false and
  /// the reason. Header, version, reasons and the tests' names are left to the caller. Deterministic; may take a
  /// minute; called by one thread at a time, not always the same.
  [[nodiscard]] virtual ModelDiscrepancy explain(const AssetConfig& asset, std::span<const Recording> fit,
                                                 std::span<const Recording> holdout) const = 0;
};

}  // namespace sealwatch

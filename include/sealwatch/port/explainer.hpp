// Port through which health assessment reaches the mismatch analysis; implemented in services/common/mismatch, injected
// by main.
#pragma once

#include <span>
#include <stop_token>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/core/recording.hpp"
#include "sealwatch/message/health_assessment.hpp"

namespace sealwatch {

class Explainer {
 public:
  virtual ~Explainer() = default;
  /// Verdict, location, physics and the explained model. What cannot be analysed comes back with analysed = false and
  /// the reason. Header, version, reasons and the tests' names are left to the caller. Deterministic where its time
  /// limit does not cut it; `cancel` ends it within a second, not analysed; called by several threads at once.
  [[nodiscard]] virtual ModelDiscrepancy explain(const AssetConfig& asset, std::span<const Recording> fit,
                                                 std::span<const Recording> holdout,
                                                 const std::stop_token& cancel) const = 0;
};

}  // namespace sealwatch

// How each quantity is judged when the asset's file (alert_limits) says nothing else.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/message/state_detection.hpp"

namespace sealwatch {

enum class Side { both, above };

/// Tolerance of a quantity about its own baseline: the larger of the two parts (services/state_detection/baseline.hpp).
struct BaselineRule {
  double relative = 0.0;  ///< share of the baseline's mean
  double absolute = 0.0;  ///< in the quantity's unit
  Side side = Side::both;
};

/// Limits that do not depend on the asset's history: from alert_limits, else the default of docs/health.md; nothing
/// when the quantity is judged against the baseline alone.
[[nodiscard]] std::optional<AlertLimits> fixed_limits(const AssetConfig& asset, const std::string& quantity);

/// Nothing when the quantity is not judged against the baseline.
[[nodiscard]] std::optional<BaselineRule> baseline_rule(const AssetConfig& asset, std::string_view quantity);

/// Whether the asset's condition goes by its seal's leakage, which the test's standstills show.
[[nodiscard]] bool goes_by_leakage(const AssetConfig& asset);

/// Of the asset, by the parameter of that role; nothing where its plant has none.
[[nodiscard]] std::optional<double> whole_stroke_m(const AssetConfig& asset);

/// Longest extrapolated closing time that passes [s]: 60 s, or what the test's own ramp takes where that is slower.
[[nodiscard]] double longest_closing_time_s(const AssetConfig& asset);

}  // namespace sealwatch

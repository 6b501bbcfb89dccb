// The quantities that state detection judges, by the names that `alert_limits` of an asset's file, judgements and
// docs/health.md have for them. What each indicator is: services/state_detection/indicators.hpp.
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace sealwatch {

struct JudgedIndicator {
  std::string_view name;
  std::string_view unit;
};

inline constexpr std::array kJudgedIndicators = {
    JudgedIndicator{"leakage_resistance", "Pa s/m3"},
    JudgedIndicator{"condition", "1"},
    JudgedIndicator{"friction_pressure", "Pa"},
    JudgedIndicator{"breakaway_pressure", "Pa"},
    JudgedIndicator{"load_pressure", "Pa"},
    JudgedIndicator{"load_free_current", "A"},
    JudgedIndicator{"hold_decay_rate", "1/s"},
    JudgedIndicator{"pump_slip", "m3/(s Pa)"},
    JudgedIndicator{"shaft_drag", "N m s/rad"},
    JudgedIndicator{"back_emf", "V s/rad"},
    JudgedIndicator{"flow_gain", "1"},
    JudgedIndicator{"delivery_ratio", "1"},
    JudgedIndicator{"velocity_gain", "1"},
    JudgedIndicator{"closing_time", "s"},
    JudgedIndicator{"fluid_temperature_deviation", "K"},
    JudgedIndicator{"drive_saturation", "1"},
    JudgedIndicator{"missing_share", "1"},
};

/// "residual." + simulated channel: how far the model is from it.
inline constexpr std::string_view kResidualQuantity = "residual.";
/// "channel." + channel: whether it was lost.
inline constexpr std::string_view kChannelQuantity = "channel.";

/// The indicator of that name; nullptr where there is none.
[[nodiscard]] constexpr const JudgedIndicator* find_indicator(std::string_view name) {
  const auto* const found = std::ranges::find(kJudgedIndicators, name, &JudgedIndicator::name);
  return found == kJudgedIndicators.end() ? nullptr : found;
}

/// All names that may be judged of a plant with these channels: `simulated` ones have a residual, `measured` ones may
/// be lost.
[[nodiscard]] inline std::vector<std::string> judged_quantities(const std::vector<std::string>& simulated,
                                                                const std::vector<std::string>& measured) {
  std::vector<std::string> names;
  names.reserve(kJudgedIndicators.size() + simulated.size() + measured.size());
  for (const JudgedIndicator& indicator : kJudgedIndicators) names.emplace_back(indicator.name);
  for (const std::string& channel : simulated) names.push_back(std::string(kResidualQuantity).append(channel));
  for (const std::string& channel : measured) names.push_back(std::string(kChannelQuantity).append(channel));
  return names;
}

}  // namespace sealwatch

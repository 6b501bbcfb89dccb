// Internal leakage of plant `eha_switched` from stretches in which the directional valves block all ports: only the
// piston seal joins the chambers then, and no pump leakage hides it.
//
//   C_A dp_A/dt = -G (p_A - p_B),   C_B dp_B/dt = G (p_A - p_B),   G = 1/R_CL,   C = (V_0 + V_pipe + A x) / b(p)
//
// Slopes by straight lines over each stretch, their errors from the lines' residuals (correlation from sample to sample
// taken into account); both chambers and all stretches weighted by their errors.
#pragma once

#include <optional>
#include <string>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/core/time_series.hpp"

namespace sealwatch {

struct ClosedValveLeakage {
  double conductance = 0.0, conductance_std = 0.0;  ///< m3/(s Pa)
  double duration_s = 0.0;                          ///< of all stretches
  double largest_difference_Pa = 0.0;               ///< |p_A - p_B|
};

/// Nothing for other plants, without both pressures, or where the valves never stay closed for a second.
[[nodiscard]] std::optional<ClosedValveLeakage> closed_valve_leakage(const AssetConfig& asset,
                                                                     const TimeSeries& samples);

/// "R_CL 1.2e12 +- 0.1e12 Pa s/m3 while the valves were closed", or from which resistance on a leak would not have
/// shown.
[[nodiscard]] std::string in_words(const ClosedValveLeakage& leakage);

}  // namespace sealwatch

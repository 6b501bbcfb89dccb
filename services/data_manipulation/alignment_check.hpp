// Do the channels of a test agree in time and in sign?
//
// dx/dt, velocity and flow show the same motion (flow = A_A v + V_A/beta dp_A/dt but for leakage); shaft speed, motor
// voltage and duty at least its sign. Each is held against dx/dt, both smoothed without phase and each delayed by the
// other's sensor time constant, so that what the sensors explain is no offset. A channel that disagrees with the
// majority of the others is named and corrected; where there is no majority (two channels), both are named as "which
// one cannot be told" and nothing is touched. pressure_differential is held against p_A - p_B. Not checked, as nothing
// recorded says the same: single pressures, current, force, temperature.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "sealwatch/message/data_manipulation.hpp"
#include "services/data_manipulation/asset_view.hpp"
#include "services/data_manipulation/options.hpp"
#include "services/data_manipulation/window.hpp"

namespace sealwatch {

struct Alignment {
  std::vector<AlignmentRemark> remarks;  ///< only of channels about which something was noticed
  std::map<std::string, Correction> corrections;
};

/// `samples` uniform.
[[nodiscard]] Alignment check_alignment(const TimeSeries& samples, const AssetView& asset,
                                        const DataManipulationOptions& options);

}  // namespace sealwatch

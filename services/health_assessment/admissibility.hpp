// Whether a test's recording may be used for prognosis. A test that may not is kept and marked with the reasons.
//
//   - the test was not judged (cut, no position, not a stroke test) or aborted
//   - no hold was found: the holds are the mandatory control of the leakage resistance (docs/estimation.md)
//   - the drive was saturated, the oil off its temperature, or too many samples were missing: the test alone stands in
//     the warning region of drive_saturation, fluid_temperature_deviation or missing_share
//   - neither the cylinder circuit (flow, pressures or their difference, position or velocity) nor the whole actuator
//     (voltage or duty, shaft speed, a pressure, position) has all its channels in order; of a plant without a
//     cylinder: no output is
#pragma once

#include <string>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/message/data_manipulation.hpp"
#include "sealwatch/message/state_detection.hpp"

namespace sealwatch {

/// Empty when admissible.
[[nodiscard]] std::vector<std::string> inadmissible_reasons(const AssetConfig& asset, const StateReport& report,
                                                            const TestFeatures& features);

/// Whether the recording of a judged test is too poor to say anything about the actuator: saturated, off temperature,
/// too many samples missing.
[[nodiscard]] bool is_poor_recording(const StateReport& report);

}  // namespace sealwatch

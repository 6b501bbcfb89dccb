// Tables of the report of a verification, as HTML.
#pragma once

#include <string>

#include "services/verification/lives/summary.hpp"

namespace sealwatch::cli {

[[nodiscard]] std::string verification_overview(const verification::Summary& summary);
/// The measures of the source.
[[nodiscard]] std::string verification_main_table(const verification::Summary& summary);
/// Alarms, the published metrics of the field, the oracle.
[[nodiscard]] std::string verification_alarm_table(const verification::Summary& summary);
/// Coverage, CRPS and interval scores at each horizon.
[[nodiscard]] std::string verification_coverage_table(const verification::Summary& summary);

}  // namespace sealwatch::cli

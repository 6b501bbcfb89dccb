// Records of the blind trial as JSON lines, both ways, and the results as JSON.
#pragma once

#include <span>
#include <string>

#include "sealwatch/core/result.hpp"
#include "services/verification/trial/mismatch_summary.hpp"

namespace sealwatch::cli {

/// One line, without its end.
[[nodiscard]] std::string to_json_line(const verification::MismatchRecord& record);

/// All records of a file; none when there is no such file. A last line that was cut off is passed over, any other that
/// cannot be read is an Error with file and line.
[[nodiscard]] Result<std::vector<verification::MismatchRecord>> read_mismatch_records(const std::string& file);

[[nodiscard]] std::string tallies_to_json(std::span<const verification::TrialTally> tallies);

}  // namespace sealwatch::cli

// Samples of a recording in CSV.
//
// A file that was cut off in its last line is told from one whose last line break is missing (which RFC 4180 allows):
// without a line break, the last row must have all cells, and its last number at least as many characters after the
// decimal point as the shortest number of that column above it. A cut exactly after a line break leaves a valid,
// shorter recording.
#pragma once

#include <istream>

#include "services/common/recording/columns.hpp"

namespace sealwatch {

/// Reads the whole stream. Errors name row and column, not the file. `jumps`: rows of one time are before and after a jump.
[[nodiscard]] Result<ColumnarSamples> read_csv(std::istream& in, const PlantDescription& plant, bool jumps = false);

}  // namespace sealwatch

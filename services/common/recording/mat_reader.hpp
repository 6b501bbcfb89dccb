// Samples of a recording in a MATLAB file, v5 or v7.3: one real vector per channel, named as the channel, SI units
// (a MATLAB name has no room for a unit).
#pragma once

#include <string>

#include "services/common/recording/columns.hpp"

namespace sealwatch {

/// Reads `path`. Errors name row and column, not the file. One file is read at a time, whatever the thread: HDF5 as
/// Debian builds it allows no more.
[[nodiscard]] Result<ColumnarSamples> read_mat(const std::string& path, const PlantDescription& plant);

}  // namespace sealwatch

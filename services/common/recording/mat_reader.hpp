// Samples of a recording in a MATLAB file, v5 or v7.3: one real vector per channel, named as the channel, SI units
// (a MATLAB name has no room for a unit).
#pragma once

#include <string>
#include <vector>

#include "services/common/recording/columns.hpp"
#include "services/common/recording/hdf5_child.hpp"

namespace sealwatch {

/// Reads `path`. Errors name row and column, not the file. One file is read at a time, whatever the thread: HDF5 as
/// Debian builds it allows no more.
[[nodiscard]] Result<ColumnarSamples> read_mat(const std::string& path, const PlantDescription& plant);

/// All vectors of real numbers in `path`, the columns of matrices and the fields of structs among them, by their path; of
/// text, cells, objects and complex numbers the names and why they are none.
[[nodiscard]] Result<std::vector<MatVariable>> read_mat_vectors(const std::string& path);

}  // namespace sealwatch

// Vectors of numbers in an HDF5 file: data sets of one dimension (or one row, or one column) and the members of tables.
//
// A vector's name is its path, "run1/pressure_a"; its unit the attribute `unit` or `units`. What is no vector of real
// numbers is passed over.
#pragma once

#include <string>
#include <vector>

#include "sealwatch/core/result.hpp"
#include "services/common/recording/hdf5_child.hpp"

namespace sealwatch {

/// Reads `path` in a child process (hdf5_child.hpp says why).
[[nodiscard]] Result<std::vector<MatVariable>> read_hdf5_vectors(const std::string& path);

}  // namespace sealwatch

// Vectors of numbers in an HDF5 file: data sets of one dimension, the columns of those of two, the members of tables.
//
// A vector's name is its path, "run1/pressure_a", of a matrix with the column's name or number behind it; what its
// attributes say of the numbers is followed (hdf5_attributes.hpp). Text, objects of MATLAB and complex numbers are named
// without values; what else is no vector of real numbers is passed over.
#pragma once

#include <string>
#include <vector>

#include "sealwatch/core/result.hpp"
#include "services/common/recording/hdf5_child.hpp"

namespace sealwatch {

/// Reads `path` in a child process (hdf5_child.hpp says why).
[[nodiscard]] Result<std::vector<MatVariable>> read_hdf5_vectors(const std::string& path);

}  // namespace sealwatch

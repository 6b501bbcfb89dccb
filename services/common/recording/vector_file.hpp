// A recording from named vectors of numbers, as HDF5 and MATLAB files hold them, by a channel map.
#pragma once

#include <string>
#include <vector>

#include "services/common/recording/hdf5_child.hpp"
#include "services/common/recording/log_columns.hpp"
#include "services/common/recording/log_reader.hpp"

namespace sealwatch {

/// The vectors as columns: by the last part of their path where that is a name of its own in the file and tells
/// something, and no column of the map is the whole path.
[[nodiscard]] std::vector<OfferedColumn> offered_vectors(const std::vector<MatVariable>& vectors,
                                                         const ChannelMap& map);

/// Vectors are named by their path or its last part; those that are no channel are left aside. Errors name channel and
/// row, not the file.
[[nodiscard]] Result<Log> log_of_vectors(std::vector<MatVariable> vectors, const PlantDescription& plant,
                                         const ChannelMap& map);

}  // namespace sealwatch

// What matio takes on trust in a MATLAB file. Format: "MAT-File Format", The MathWorks (level 5 and 7.3).
#pragma once

#include <string>

#include "sealwatch/core/result.hpp"

namespace sealwatch {

enum class MatFormat { version_5, version_5_nested, version_7_3 };

/// The format when matio can read `path` without filling memory by what a damaged length says: the header is one of
/// version 5 or 7.3; the chain of elements ends where the file does; a compressed element's checksum holds; every
/// length inside an element lies within it. Reads, keeps 64 kB. What HDF5 takes on trust in a file of version 7.3 is not
/// looked at, nor the inside of structs, cells and texts of version 5, which is then `version_5_nested`: matio reads both
/// in a child process (hdf5_child.hpp). Where `nested` is false, the first such variable is named and refused.
[[nodiscard]] Result<MatFormat> check_mat_container(const std::string& path, bool nested = false);

/// What to do about a variable that is no measurement.
inline constexpr const char* kIsComplex = "is complex, where one real number for each sample is needed";
inline constexpr const char* kStoreRealPart = "store its real part, or its magnitude, under a name of its own";
inline constexpr const char* kTakeOutOrStore = "take it out, or store one real number for each sample";

}  // namespace sealwatch

// Files by the names that users give. A name may be that of a pipe or a device, which would be waited for, or read, for
// ever: only files are read.
#pragma once

#include <cstdint>
#include <fstream>
#include <string>

#include "sealwatch/core/result.hpp"

namespace sealwatch {

/// Of a file that people write by hand: a configuration of a thousand assets has a tenth of it, and what the YAML library
/// makes of it takes a thousand times as much memory at worst.
inline constexpr std::uint64_t kLongestYaml_bytes = 400'000;

/// For libraries that open a name themselves: whether it is that of a file of at most `most_bytes` that may be read.
[[nodiscard]] Status check_file(const std::string& path, std::uint64_t most_bytes);

/// The file of that name, opened for reading.
[[nodiscard]] Result<std::ifstream> open_file(const std::string& path, std::uint64_t most_bytes);

/// Its content. It may grow while it is read, by no more than `most_bytes` in all.
[[nodiscard]] Result<std::string> read_file(const std::string& path, std::uint64_t most_bytes);

/// Writes `content` to the file of that name, or to a pipe or a device that takes it.
[[nodiscard]] Status write_file(const std::string& path, const std::string& content);

}  // namespace sealwatch

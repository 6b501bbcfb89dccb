// Which build this is, for each program's --version.
#pragma once

#include <string>

namespace sealwatch {

/// "sealwatch 0.1.0 (commit 1234567890, Release, GNU 12.2.0)"; "-dirty" behind a commit with changes. Made by
/// deploy/cmake/build_version.cmake.
[[nodiscard]] std::string version_line();

}  // namespace sealwatch

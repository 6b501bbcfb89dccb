// Which build this is: "commit 1234567890, Release, GNU 12.2.0"; "-dirty" behind a commit with changes.
#pragma once

#include <string_view>

namespace sealwatch::cli {

/// Made by deploy/cmake/build_version.cmake.
[[nodiscard]] std::string_view build_version();

}  // namespace sealwatch::cli

// The texts of fmi2_shell.c, fmi3_shell.c and fmi2_wrapper.c, one of which goes into every exported FMU (made by CMake
// from shell_text.cpp.in).
#pragma once

#include <string_view>

namespace sealwatch::fmi {

[[nodiscard]] std::string_view fmi2_shell_text();
[[nodiscard]] std::string_view fmi3_shell_text();
[[nodiscard]] std::string_view fmi2_wrapper_text();

}  // namespace sealwatch::fmi

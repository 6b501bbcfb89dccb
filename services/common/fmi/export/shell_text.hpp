// The texts of fmi2_shell.c, fmi3_shell.c, fmi2_wrapper.c and, behind that, fmi3_wrapper.c, of which every exported FMU
// has what it needs (made by CMake from shell_text.cpp.in). Those of FMI 3.0 end with fmi3_common.c.
#pragma once

#include <string_view>

namespace sealwatch::fmi {

[[nodiscard]] std::string_view fmi2_shell_text();
[[nodiscard]] std::string_view fmi3_shell_text();
[[nodiscard]] std::string_view fmi2_wrapper_text();
[[nodiscard]] std::string_view fmi3_wrapper_text();

}  // namespace sealwatch::fmi

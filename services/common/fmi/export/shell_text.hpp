// The text of fmi2_shell.c, which goes into every exported FMU (made by CMake from shell_text.cpp.in).
#pragma once

#include <string_view>

namespace sealwatch::fmi {

[[nodiscard]] std::string_view fmi2_shell_text();

}  // namespace sealwatch::fmi

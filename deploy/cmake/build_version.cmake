# What each program's --version says of this build, written anew by each build and only where it differs.
#   cmake -DSOURCE_DIR=... -DOUTPUT=... -DVERSION=... -DBUILD_TYPE=... -DCOMPILER=... -P build_version.cmake
execute_process(COMMAND git -C ${SOURCE_DIR} describe --always --dirty --abbrev=10 --exclude=*
                OUTPUT_VARIABLE commit ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
if(NOT commit)
  set(commit "unknown")  # built from an archive
endif()
file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT [[
#include "services/common/core/build_version.hpp"

namespace sealwatch {
std::string version_line() { return "sealwatch @VERSION@ (commit @commit@, @BUILD_TYPE@, @COMPILER@)"; }
}  // namespace sealwatch
]])

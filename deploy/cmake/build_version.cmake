# What `sealwatch --version` says of this build, written anew by each build and only where it differs.
#   cmake -DSOURCE_DIR=... -DOUTPUT=... -DBUILD_TYPE=... -DCOMPILER=... -P build_version.cmake
execute_process(COMMAND git -C ${SOURCE_DIR} describe --always --dirty --abbrev=10 --exclude=*
                OUTPUT_VARIABLE commit ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
if(NOT commit)
  set(commit "unknown")  # built from an archive
endif()
file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT [[
#include "services/cli/build_version.hpp"

namespace sealwatch::cli {
std::string_view build_version() { return "commit @commit@, @BUILD_TYPE@, @COMPILER@"; }
}  // namespace sealwatch::cli
]])

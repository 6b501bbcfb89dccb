// Starts sealwatch-fmu-host with its shared memory, its limits and nothing else of this process.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>

#include "sealwatch/core/result.hpp"

namespace sealwatch::fmi {

struct LaunchedHost {
  pid_t process = -1;
  void* memory = nullptr;  ///< shared with it, all zero, of fixed size
  int life = -1;           ///< whoever holds it lets the process live
  int output = -1;         ///< what it prints can be read here
};

[[nodiscard]] Result<LaunchedHost> launch_host(std::size_t shared_bytes, std::uint64_t memory_limit_bytes);

}  // namespace sealwatch::fmi

// Command line and loop of the virtual bench's process.
#pragma once

#include <functional>
#include <memory>

#include "sealwatch/config/configuration.hpp"
#include "sealwatch/port/bus.hpp"

namespace sealwatch::bench {

using BusMaker = std::function<Result<std::unique_ptr<Bus>>(const Configuration&)>;

/// Exit status as a daemon's: 0 stopped by SIGTERM or SIGINT, 2 bad usage or configuration, 3 internal failure. It
/// throws nothing.
[[nodiscard]] int run_bench(int argc, const char* const* argv, const BusMaker& make_bus);

}  // namespace sealwatch::bench

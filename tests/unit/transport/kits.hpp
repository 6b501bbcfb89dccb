// Ways to connect buses in one test process: the contract suite runs over each of them. Every test process has a tag
// (and so a DDS network) of its own, whatever the environment says.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "services/common/transport/dds_bus.hpp"

namespace sealwatch::test {

/// Cyclone settings for the test process: loopback, own tag; domains of different ids in it meet in external domain 0.
[[nodiscard]] std::string isolated_settings();

[[nodiscard]] Configuration isolated_configuration(std::int32_t domain);

class Kit {
 public:
  virtual ~Kit() = default;
  /// One more bus, connected with those opened before; null when it cannot be had.
  [[nodiscard]] virtual std::unique_ptr<Bus> open() = 0;
};
using KitMaker = std::unique_ptr<Kit> (*)();

[[nodiscard]] std::unique_ptr<Kit> in_memory_kit();
/// Participants of one domain in one process: Cyclone hands samples over without its network stack.
[[nodiscard]] std::unique_ptr<Kit> same_domain_kit();
/// Every bus in a domain of its own that meets the others over UDP, as different processes do.
[[nodiscard]] std::unique_ptr<Kit> network_kit();

}  // namespace sealwatch::test

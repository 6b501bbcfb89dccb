// Ways to connect two buses in one test process: the contract suite runs over each of them. Every test process has a
// tag (and so a DDS network) of its own, whatever the environment says.
#pragma once

#include <unistd.h>

#include <cstdlib>
#include <memory>
#include <string>

#include "sealwatch/port/in_memory_bus.hpp"
#include "services/common/transport/dds_bus.hpp"

namespace sealwatch::test {

/// Cyclone settings for the test process: loopback, own tag; domains of different ids in it meet in external domain 0.
[[nodiscard]] inline std::string isolated_settings() {
  return "<CycloneDDS><Domain Id=\"any\">"
         "<General><Interfaces><NetworkInterface name=\"lo\" multicast=\"true\"/></Interfaces></General>"
         "<Discovery><LeaseDuration>2s</LeaseDuration><ExternalDomainId>0</ExternalDomainId><Tag>unit-test-" +
         std::to_string(getpid()) + "</Tag></Discovery></Domain></CycloneDDS>";
}

[[nodiscard]] inline Configuration isolated_configuration(std::int32_t domain) {
  unsetenv("CYCLONEDDS_URI");
  Configuration configuration;
  configuration.domain = domain;
  configuration.cyclonedds_uri = isolated_settings();
  return configuration;
}

class InMemoryKit {
 public:
  [[nodiscard]] std::unique_ptr<Bus> open() { return std::make_unique<InMemoryBus>(network_); }

 private:
  std::shared_ptr<InMemoryNetwork> network_ = std::make_shared<InMemoryNetwork>();
};

/// Participants of one domain in one process: Cyclone hands samples over without its network stack.
class SameDomainKit {
 public:
  [[nodiscard]] std::unique_ptr<Bus> open() {
    auto bus = make_dds_bus(isolated_configuration(0));
    return bus ? std::move(*bus) : nullptr;
  }
};

/// Every bus in a domain of its own that meets the others over UDP, as different processes do.
class NetworkKit {
 public:
  [[nodiscard]] std::unique_ptr<Bus> open() {
    auto bus = make_dds_bus(isolated_configuration(++last_domain_));
    return bus ? std::move(*bus) : nullptr;
  }

 private:
  std::int32_t last_domain_ = 0;
};

}  // namespace sealwatch::test

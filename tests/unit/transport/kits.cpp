#include "tests/unit/transport/kits.hpp"

#include <unistd.h>

#include <cstdlib>

#include "tests/unit/port/in_memory_bus.hpp"

namespace sealwatch::test {
namespace {

std::unique_ptr<Bus> open_in_domain(std::int32_t domain) {
  auto bus = make_dds_bus(isolated_configuration(domain));
  return bus ? std::move(*bus) : nullptr;
}

class InMemoryKit final : public Kit {
 public:
  std::unique_ptr<Bus> open() override { return std::make_unique<InMemoryBus>(network_); }

 private:
  std::shared_ptr<InMemoryNetwork> network_ = std::make_shared<InMemoryNetwork>();
};

class SameDomainKit final : public Kit {
 public:
  std::unique_ptr<Bus> open() override { return open_in_domain(0); }
};

class NetworkKit final : public Kit {
 public:
  std::unique_ptr<Bus> open() override { return open_in_domain(++last_domain_); }

 private:
  std::int32_t last_domain_ = 0;
};

}  // namespace

std::string isolated_settings() {
  return "<CycloneDDS><Domain Id=\"any\">"
         "<General><Interfaces><NetworkInterface name=\"lo\" multicast=\"true\"/></Interfaces></General>"
         "<Discovery><LeaseDuration>2s</LeaseDuration><ExternalDomainId>0</ExternalDomainId><Tag>unit-test-" +
         std::to_string(getpid()) + "</Tag></Discovery></Domain></CycloneDDS>";
}

Configuration isolated_configuration(std::int32_t domain) {
  unsetenv("CYCLONEDDS_URI");
  Configuration configuration;
  configuration.domain = domain;
  configuration.cyclonedds_uri = isolated_settings();
  return configuration;
}

std::unique_ptr<Kit> in_memory_kit() { return std::make_unique<InMemoryKit>(); }
std::unique_ptr<Kit> same_domain_kit() { return std::make_unique<SameDomainKit>(); }
std::unique_ptr<Kit> network_kit() { return std::make_unique<NetworkKit>(); }

}  // namespace sealwatch::test

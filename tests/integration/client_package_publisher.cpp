// Publishes one advisory and stays until it is killed, so that whoever subscribes later gets it too.
#include <unistd.h>

#include <iostream>

#include "services/common/transport/dds_bus.hpp"

int main() {
  const auto bus = sealwatch::make_dds_bus({});
  sealwatch::Advisory advisory;
  advisory.asset_id = "XT03-MV2";
  advisory.advisory_id = "advisory-1";
  advisory.priority = sealwatch::AdvisoryPriority::high;
  advisory.recommendation = "Book a vessel for the replacement of XT03-MV2.";
  advisory.latest_by_known = true;
  advisory.latest_by_ns = 1'934'496'000'000'000'000;  // 2031-04-21
  advisory.reasons = {"the seal reaches its threshold in 14 months"};
  const auto published = bus ? (*bus)->publish(sealwatch::Message(advisory)) : sealwatch::fail(bus.error());
  if (!published) {
    std::cerr << published.error().describe() << '\n';
    return 1;
  }
  pause();
}

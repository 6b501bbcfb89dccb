#include "sealwatch/message/replacement_id.hpp"

#include <gtest/gtest.h>

namespace sealwatch {
namespace {

// `sealwatch replaced` sends a report again under the name by which the services know it; one of the seal at the moment
// for which the actuator's was reported had that name too, and nobody took it.
TEST(ReplacementId, TellsOneKindOfReportFromAnother) {
  const UtcTime at = parse_utc("2031-04-12T03:00:00Z").value();
  const std::string id = replacement_id("XT03/MV2", "actuator_replaced", {at.nanoseconds + 1}, at);
  EXPECT_TRUE(may_report(id, "XT03/MV2", "actuator_replaced"));
  EXPECT_FALSE(may_report(id, "XT03/MV2", "seal_replaced"));
  EXPECT_FALSE(may_report(id, "XT03", "actuator_replaced"));
  EXPECT_TRUE(may_report("maintenance_event/XT03/2031-04-12T03:00:00Z", "XT03", "seal_replaced")) << "an old one";
}

}  // namespace
}  // namespace sealwatch

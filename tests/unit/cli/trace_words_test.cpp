// What `validate --simulated` says of a comparison.
#include "services/cli/trace_words.hpp"

#include <gmock/gmock.h>

namespace sealwatch::cli {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

trace::ChannelComparison channel_of(std::string name, bool input, bool differs) {
  trace::ChannelComparison channel;
  channel.name = std::move(name);
  channel.input = input;
  channel.differs = differs;
  return channel;
}

TEST(TraceWords, SayWhereTheSimulationHadAnotherInput) {
  trace::TraceComparison comparison;
  comparison.consistent = false;
  comparison.channels = {channel_of("motor_voltage", true, true), channel_of("position", false, true)};
  EXPECT_THAT(trace_summary(comparison), HasSubstr("The input itself differs (motor voltage)"));
  comparison.channels.front().differs = false;
  EXPECT_THAT(trace_summary(comparison), Not(HasSubstr("The input itself")));
}

}  // namespace
}  // namespace sealwatch::cli

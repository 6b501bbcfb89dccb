// What `validate --simulated` says of a comparison.
#include "services/cli/trace_words.hpp"

#include <gmock/gmock.h>

#include <fstream>

#include "services/cli/foreign_file.hpp"

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
  comparison.answer = {{.id = "clock_rate", .where = "clock", .parameters = {}}};
  EXPECT_THAT(trace_summary(comparison), Not(HasSubstr("The input itself"))) << "it came by another clock";
  comparison.answer.clear();
  comparison.channels.front().differs = false;
  EXPECT_THAT(trace_summary(comparison), Not(HasSubstr("The input itself")));
}

TEST(TraceWords, BeginWithAChannelWhoseSignIsReversed) {
  trace::TraceComparison comparison;
  comparison.consistent = false;
  comparison.channels = {channel_of("position", false, true), channel_of("pressure_a", false, true)};
  comparison.channels.front().sign_reversed = true;
  EXPECT_EQ(
      trace_summary(comparison),
      "The sign of position is reversed. They differ beyond noise in position, pressure A. No gain, offset, delay "
      "or clock rate of a channel or of the input explains the rest.");
  comparison.channels.back().sign_reversed = true;
  EXPECT_THAT(trace_summary(comparison), ::testing::StartsWith("The sign of position, pressure A is reversed, as if "
                                                               "the input's were: check both"));
}

TEST(TraceWords, NameADeadChannelAndAllThatExplainsTheRest) {
  trace::TraceComparison comparison;
  comparison.consistent = false;
  comparison.channels = {channel_of("position", false, true)};
  comparison.channels.front().stands_still = true;
  EXPECT_EQ(trace_summary(comparison),
            "They differ beyond noise in position. Recorded position does not move, but simulated it does: check the "
            "sensor and its cable.");
  comparison.channels.push_back(channel_of("pressure_a", false, true));
  comparison.answer = {{.id = "sensor_lag", .where = "sensor:pressure_a", .parameters = {}}};
  comparison.equally = {{.id = "input_delay", .where = "input", .parameters = {}}};
  EXPECT_THAT(trace_summary(comparison), HasSubstr("This explains the rest: sensor lag of pressure A. So does input "
                                                   "delay; a trace cannot tell them apart."));
}

// A column of remarks, empty in all rows, is no channel whose rows are incomplete.
TEST(AnyChannels, AColumnWithoutANumberIsNone) {
  const std::string file = ::testing::TempDir() + "sealwatch_any_channels.csv";
  std::ofstream(file) << "Time;Pressure [barg];Remark\n0;1,0;\n0,1;1,1;\n0,2;1,2;\n";
  const Result<Recording> recording = read_any_channels(file, {});
  ASSERT_TRUE(recording) << recording.error().describe();
  ASSERT_EQ(recording->samples.channels.size(), 1U);
  EXPECT_EQ(recording->samples.channels.front().name, "Pressure");
}

// Of two files one may be the log that the map is of, and the other in the project's own format.
TEST(AnyChannels, AMapOfTheOtherFileSaysNothingOfThisOnesLayout) {
  const std::string file = ::testing::TempDir() + "sealwatch_any_channels.csv";
  std::ofstream(file) << "time[s],pressure[bar]\n0,1.25\n0.1,1.5\n";
  ChannelMap map{.columns = {{"time", {.column = "Zeit", .unit = "s"}}, {"pressure", {.column = "PT", .unit = "bar"}}},
                 .log = {}};
  map.log.delimiter = "semicolon", map.log.decimal = "comma", map.log.header_row = 5;
  const Result<Recording> recording = read_any_channels(file, map);
  ASSERT_TRUE(recording) << recording.error().describe();
  EXPECT_EQ(recording->samples.find("pressure")->values.back(), 1.5e5);
}

// A simulation has the log's columns, or names of its own, or some of each; its time seldom is a clock.
TEST(AnyChannels, ASimulationIsReadByTheLogsMapOrItsOwnNames) {
  const std::string file = ::testing::TempDir() + "sealwatch_any_channels.csv";
  ChannelMap map{.columns = {{"time", {.column = "Day + Time", .unit = "%d.%m.%Y %H:%M:%S"}},
                             {"pressure", {.column = "PT", .unit = "bar"}},
                             {"position", {.column = "LVDT", .unit = "mm"}}},
                 .log = {}};
  map.log.delimiter = "semicolon";
  const auto read = [&](const std::string& text) {
    std::ofstream(file) << text;
    const Result<Recording> recording = read_simulated_channels(file, map);
    EXPECT_TRUE(recording) << recording.error().describe();
    EXPECT_EQ(recording->samples.find("pressure")->values.back(), 1.5e5) << text;
    EXPECT_EQ(recording->samples.find("position")->values.back(), 0.002) << text;
    EXPECT_NEAR(recording->samples.time_s.back() - recording->samples.time_s.front(), 0.1, 1e-9) << text;
  };
  read("Day;Time;PT;LVDT\n12.04.2031;03:00:00,0;1.25;1\n12.04.2031;03:00:00,1;1.5;2\n");
  read("Time,PT,LVDT\n0,1.25,1\n0.1,1.5,2\n");
  read("time[s],pressure[bar],position[m]\n0,1.25,0.001\n0.1,1.5,0.002\n");
  read("t,PT,position\n0,1.25,0.001\n0.1,1.5,0.002\n");
  map.columns["time"] = {.column = "Time", .unit = "%H:%M:%S"};
  read("Time,PT,LVDT\n0,1.25,1\n0.1,1.5,2\n");
}

}  // namespace
}  // namespace sealwatch::cli

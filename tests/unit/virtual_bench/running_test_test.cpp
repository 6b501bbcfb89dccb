#include "services/virtual_bench/running_test.hpp"

#include <gtest/gtest.h>

namespace sealwatch::bench {
namespace {

Recording ten_samples() {
  Recording recording;
  recording.recording_id = std::string("R1");
  recording.asset_id = std::string("X1");
  recording.start_time = parse_utc("2031-04-12").value();
  for (int k = 0; k < 10; ++k) recording.samples.time_s.push_back(k);
  recording.samples.channels = {
      {.name = "position", .unit = "m", .noise_std = 0.5, .values = recording.samples.time_s}};
  return recording;
}

UtcTime at(double seconds) { return add_seconds(parse_utc("2031-04-12").value(), seconds); }

TEST(RunningTest, SendsBlocksWhenTheirTimeHasPassed) {
  RunningTest test(ten_samples(), {"pst_request/1"}, 4.0);
  EXPECT_TRUE(test.take_until(at(2.9)).empty());
  const std::vector<RawSamples> first = test.take_until(at(3.0));
  ASSERT_EQ(first.size(), 1U);
  EXPECT_EQ(first[0].boundary, BlockBoundary::begin);
  EXPECT_EQ(first[0].header.message_id, "raw_samples/X1/R1/0");
  EXPECT_EQ(first[0].header.source_ids, std::vector<std::string>{"pst_request/1"});
  EXPECT_TRUE(first[0].start_time_known);
  const std::vector<RawSamples> rest = test.take_until(at(100.0));
  ASSERT_EQ(rest.size(), 2U);
  EXPECT_EQ(rest[0].boundary, BlockBoundary::inside);
  EXPECT_EQ(rest[1].boundary, BlockBoundary::end);
  EXPECT_EQ(rest[1].block_number, 2U);
  EXPECT_EQ(rest[1].samples.time_s, (std::vector<double>{8.0, 9.0}));
  EXPECT_EQ(rest[1].samples.channels[0].values, (std::vector<double>{8.0, 9.0}));
  EXPECT_EQ(rest[1].samples.channels[0].noise_std, 0.5);
  EXPECT_TRUE(test.finished());
  EXPECT_EQ(test.end(), at(9.0));
}

TEST(RunningTest, OneBlockIsWhole) {
  RunningTest test(ten_samples(), {}, 60.0);
  const std::vector<RawSamples> blocks = test.take_until(at(9.0));
  ASSERT_EQ(blocks.size(), 1U);
  EXPECT_EQ(blocks[0].boundary, BlockBoundary::whole);
  EXPECT_FALSE(blocks[0].aborted);
}

TEST(RunningTest, AnAbortEndsItWithWhatWasRecorded) {
  RunningTest test(ten_samples(), {}, 4.0);
  (void)test.take_until(at(5.5));
  const RawSamples last = test.abort(at(5.5), "because");
  EXPECT_EQ(last.boundary, BlockBoundary::end);
  EXPECT_TRUE(last.aborted);
  EXPECT_EQ(last.abort_reason, "because");
  EXPECT_EQ(last.samples.time_s, (std::vector<double>{4.0, 5.0}));
  EXPECT_TRUE(test.finished());
  EXPECT_TRUE(test.take_until(at(100.0)).empty());
}

}  // namespace
}  // namespace sealwatch::bench

#include "services/cli/replay_source.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sealwatch::cli {
namespace {

TEST(ReplaySource, NeedsAtLeastOneFileThatIsThere) {
  ReplayOptions options;
  options.recordings = {"/nowhere/a.csv", "/nowhere/b.csv"};
  ::testing::internal::CaptureStderr();
  EXPECT_FALSE(ReplaySource::open(options, {}));
  EXPECT_THAT(::testing::internal::GetCapturedStderr(),
              ::testing::AllOf(::testing::HasSubstr("/nowhere/a.csv"), ::testing::HasSubstr("/nowhere/b.csv")));
}

}  // namespace
}  // namespace sealwatch::cli

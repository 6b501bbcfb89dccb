// What comes too late is listed, and what the report rests on is done all the same.
#include "services/common/mismatch/time_budget.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sealwatch::mismatch {
namespace {

TEST(TimeBudget, ListsWhatCameTooLate) {
  TimeBudget time(1e6, {});
  time.allow(0.75);
  EXPECT_TRUE(time.in_time("pairs"));
  time.allow(0.0);
  EXPECT_FALSE(time.in_time("plainer laws"));
  time.add_not_asked({"closed forms"});
  EXPECT_THAT(time.not_asked(), testing::ElementsAre("plainer laws", "closed forms"));
}

TEST(TimeBudget, WhatIsNeededIsDoneWhateverTimeItTakes) {
  TimeBudget time(1e6, {});
  time.allow(0.0);
  time.allow_what_is_needed();
  EXPECT_TRUE(time.in_time("the proof"));
  EXPECT_TRUE(time.not_asked().empty());
}

TEST(TimeBudget, WhoeverCancelsEndsThatToo) {
  std::stop_source cancel;
  TimeBudget time(1e6, cancel.get_token());
  time.allow_what_is_needed();
  cancel.request_stop();
  EXPECT_FALSE(time.in_time("the proof"));
}

}  // namespace
}  // namespace sealwatch::mismatch

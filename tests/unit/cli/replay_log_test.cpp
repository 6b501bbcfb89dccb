#include "services/cli/replay_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sealwatch/core/time.hpp"

namespace sealwatch::cli {
namespace {

using ::testing::HasSubstr;

template <typename M>
Message of_test(const std::string& date) {
  M message;
  message.asset_id = "A";
  message.header.pst_id = "A-" + date;
  message.header.event_time_known = true;
  message.header.event_time_ns = parse_utc(date).value().nanoseconds;
  return message;
}

class WithoutAdvice : public ::testing::Test {
 protected:
  static ReplayOptions quiet() {
    ReplayOptions options;
    options.quiet = true;
    return options;
  }
  ReplayLog log_{quiet(), 2};
};

TEST_F(WithoutAdvice, SaysThatAllWasKnown) {
  log_.take_earlier(of_test<RemainingLife>("2031-04-12"));
  EXPECT_THAT(log_.without_advice(), HasSubstr("were known already"));
}

TEST_F(WithoutAdvice, TakesARefusedTestForNoKnownOne) {
  log_.take_earlier(of_test<RemainingLife>("2031-04-12"));
  EXPECT_FALSE(log_.any_refused());
  log_.refuse("recording PST-8 of A: its start time lies in the future");
  EXPECT_EQ(log_.without_advice(), "");
  EXPECT_TRUE(log_.any_refused());
}

TEST_F(WithoutAdvice, TellsEarlierTestsFromKnownOnes) {
  log_.take_earlier(of_test<RemainingLife>("2031-04-12"));
  log_.take(of_test<RemainingLife>("2031-01-12"));
  EXPECT_EQ(log_.without_advice(),
            "1 test is earlier than the newest test or replacement that was known: taken into the history; the advice "
            "stands");
  log_.take(of_test<RemainingLife>("2031-02-12"));
  EXPECT_THAT(log_.without_advice(), HasSubstr("2 tests are earlier than"));
}

/// Two assets may give their tests the same ids.
TEST_F(WithoutAdvice, CountsTheTestsOfEachAsset) {
  Message other = of_test<RemainingLife>("2031-05-12");
  std::get<RemainingLife>(other).asset_id = "B";
  log_.take(other);
  log_.take(of_test<RemainingLife>("2031-05-12"));
  EXPECT_THAT(log_.without_advice(), HasSubstr("2 tests gave no new advice"));
  log_.take(of_test<Advisory>("2031-05-12"));
  EXPECT_THAT(log_.without_advice(), HasSubstr("1 test gave no new advice"));
}

TEST_F(WithoutAdvice, IsSilentWhereEachTestGaveAdvice) {
  log_.take_earlier(of_test<RemainingLife>("2031-04-12"));
  log_.take(of_test<RemainingLife>("2031-05-12"));
  EXPECT_THAT(log_.without_advice(), HasSubstr("1 test gave no new advice")) << "advisory generation may be elsewhere";
  log_.take(of_test<Advisory>("2031-05-12"));
  EXPECT_EQ(log_.without_advice(), "");
}

}  // namespace
}  // namespace sealwatch::cli

// The memory of verdicts: k of n upwards, a row downwards, dates with a dead band, and its line of text.
#include "services/advisory_generation/verdicts.hpp"

#include <gtest/gtest.h>

namespace sealwatch::advisory_generation {
namespace {

const UtcTime kNow = parse_utc("2015-01-01").value();
UtcTime day(const char* text) { return parse_utc(text).value(); }

class VerdictMemoryTest : public testing::Test {
 protected:
  WearLevel wear(WearLevel level, bool urgent = false) {
    return memory_.judge({.wear = level, .urgent = urgent}, kNow, {}).wear;
  }
  UtcTime date(const char* text) {
    return *memory_.judge({.wear = WearLevel::plan, .replace_by = day(text)}, kNow, {}).replace_by;
  }
  VerdictMemory memory_;
};

TEST_F(VerdictMemoryTest, OneTestDoesNotEscalateTwoOfThreeDo) {
  EXPECT_EQ(wear(WearLevel::none), WearLevel::none);
  EXPECT_EQ(wear(WearLevel::book), WearLevel::none);
  EXPECT_EQ(wear(WearLevel::none), WearLevel::none);
  EXPECT_EQ(wear(WearLevel::plan), WearLevel::plan);  // book and plan of the last three: plan is what both reach
  EXPECT_EQ(wear(WearLevel::book), WearLevel::plan);
  EXPECT_EQ(wear(WearLevel::book), WearLevel::book);
}

TEST_F(VerdictMemoryTest, UrgentNeedsNoConfirmation) {
  EXPECT_EQ(wear(WearLevel::none), WearLevel::none);
  EXPECT_EQ(wear(WearLevel::replace, true), WearLevel::replace);
}

TEST_F(VerdictMemoryTest, EasesOnlyAfterFourTestsInARow) {
  wear(WearLevel::book);
  EXPECT_EQ(wear(WearLevel::book), WearLevel::book);
  for (int test = 0; test < 3; ++test) EXPECT_EQ(wear(WearLevel::none), WearLevel::book);
  EXPECT_EQ(wear(WearLevel::none), WearLevel::none);
}

TEST_F(VerdictMemoryTest, TestsThatSayNothingDoNotVote) {
  wear(WearLevel::book);
  wear(WearLevel::book);
  for (int test = 0; test < 10; ++test) EXPECT_EQ(memory_.judge({}, kNow, {}).wear, WearLevel::book);
}

TEST_F(VerdictMemoryTest, DateMovesEarlierWhenConfirmedAndLaterAfterARow) {
  EXPECT_EQ(date("2018-06-01"), day("2018-06-01"));
  EXPECT_EQ(date("2017-06-01"), day("2018-06-01"));
  EXPECT_EQ(date("2017-06-01"), day("2017-06-01"));
  for (int test = 0; test < 3; ++test) EXPECT_EQ(date("2019-06-01"), day("2017-06-01"));
  EXPECT_EQ(date("2019-06-01"), day("2019-06-01"));
}

TEST_F(VerdictMemoryTest, SmallChangesDoNotMoveTheDate) {
  date("2018-06-01");  // 41 months to go: the dead band is 4.1 months
  for (int test = 0; test < 3; ++test) EXPECT_EQ(date("2018-03-01"), day("2018-06-01"));
  date("2018-01-01");
  EXPECT_EQ(date("2018-01-01"), day("2018-01-01"));
}

TEST_F(VerdictMemoryTest, ADateThatHasPassedIsNamedNoMore) {
  date("2014-12-01");  // before kNow, and the test itself means it: late is late
  EXPECT_EQ(date("2014-12-20"), day("2014-12-01"));
  EXPECT_EQ(date("2017-06-01"), day("2017-06-01"));
}

TEST_F(VerdictMemoryTest, ADateThatNoTestNamesAnyMoreIsForgotten) {
  date("2018-06-01");
  const TestVerdict without_date{.wear = WearLevel::plan};
  for (int test = 0; test < 3; ++test) EXPECT_EQ(memory_.judge(without_date, kNow, {}).replace_by, day("2018-06-01"));
  EXPECT_FALSE(memory_.judge(without_date, kNow, {}).replace_by.has_value());
}

TEST_F(VerdictMemoryTest, DatesOfLongAgoDoNotVote) {
  date("2018-06-01");
  date("2016-06-01");  // one of three: not confirmed
  for (int test = 0; test < 3; ++test) (void)memory_.judge({.wear = WearLevel::plan}, kNow, {});
  EXPECT_EQ(date("2016-06-01"), day("2018-06-01")) << "the other vote for 2016 is four tests old";
}

TEST_F(VerdictMemoryTest, DoubtInInstrumentsIsConfirmedAndGivenUpAlike) {
  const TestVerdict doubted{.instruments_doubted = true};
  EXPECT_FALSE(memory_.judge(doubted, kNow, {}).instruments_doubted);
  EXPECT_TRUE(memory_.judge(doubted, kNow, {}).instruments_doubted);
  for (int test = 0; test < 3; ++test) EXPECT_TRUE(memory_.judge({}, kNow, {}).instruments_doubted);
  EXPECT_FALSE(memory_.judge({}, kNow, {}).instruments_doubted);
}

TEST_F(VerdictMemoryTest, KeepsTheNamesOfDoubtedChannelsWhileTheyCount) {
  const auto names = [this](const TestVerdict& verdict) { return memory_.judge(verdict, kNow, {}).doubted_channels; };
  const TestVerdict flow{.instruments_doubted = true, .doubted_channels = {"flow"}};
  const TestVerdict position{.instruments_doubted = true, .doubted_channels = {"position"}};
  const std::set<std::string> both = {"flow", "position"};
  EXPECT_TRUE(names(flow).empty()) << "not confirmed";
  EXPECT_EQ(names(position), both);
  EXPECT_EQ(names({}), both);
  EXPECT_EQ(names({}), both);
  EXPECT_EQ(names({}), std::set<std::string>{"position"}) << "the doubt in flow is four tests old";
  EXPECT_TRUE(names({}).empty());
}

TEST(VerdictWords, NameTheDoubtedChannels) {
  const TestVerdict verdict{.instruments_doubted = true, .doubted_channels = {"flow", "position"}};
  const InForce in_force{.instruments_doubted = true, .doubted_channels = {"position"}};
  const std::string line = in_words(verdict, in_force);
  EXPECT_NE(line.find("; instruments doubted: flow, position; stroke done."), std::string::npos) << line;
  const auto record = from_words(line);
  ASSERT_TRUE(record);
  EXPECT_EQ(record->verdict, verdict);
  EXPECT_EQ(record->in_force, in_force);
}

TEST(VerdictWords, RoundTripOfEveryField) {
  for (const bool doubted : {false, true})
    for (const bool failed : {false, true})
      for (const std::optional<WearLevel> wear : {std::optional<WearLevel>(), std::optional(WearLevel::book_at_once)})
        for (const std::optional<UtcTime> date : {std::optional<UtcTime>(), std::optional(day("2017-06-01"))}) {
          const TestVerdict verdict{.wear = wear, .replace_by = date, .instruments_doubted = doubted, .failed = failed};
          const InForce in_force{
              .wear = WearLevel::replace, .replace_by = date, .instruments_doubted = failed, .failing = doubted};
          const auto record = from_words(in_words(verdict, in_force));
          ASSERT_TRUE(record);
          EXPECT_EQ(record->verdict, verdict);
          EXPECT_EQ(record->in_force, in_force);
        }
}

TEST(VerdictWords, RoundTripOfWhatWouldHoldACampaignEarlier) {
  const TestVerdict verdict{
      .wear = WearLevel::none, .wear_a_campaign_earlier = WearLevel::book_at_once, .replace_by = day("2017-06-01")};
  const auto record = from_words(in_words(verdict, {.wear = WearLevel::plan}));
  ASSERT_TRUE(record);
  EXPECT_EQ(record->verdict, verdict);
  EXPECT_EQ(record->in_force, InForce{.wear = WearLevel::plan});
  const InForce as_the_test{.wear = WearLevel::none, .replace_by = verdict.replace_by};
  const std::string same = in_words(verdict, as_the_test);
  EXPECT_TRUE(same.ends_with("together they say the same")) << same;
  ASSERT_TRUE(from_words(same));
  EXPECT_EQ(from_words(same)->in_force, as_the_test);
  EXPECT_EQ(from_words(same)->verdict, verdict);
}

TEST_F(VerdictMemoryTest, IsNotEasedWhileACampaignEarlierWouldCallForAsMuch) {
  const TestVerdict plan{.wear = WearLevel::plan};
  const TestVerdict none_but_near{.wear = WearLevel::none, .wear_a_campaign_earlier = WearLevel::book};
  for (int test = 0; test < 2; ++test) (void)memory_.judge(plan, kNow, {});
  for (int test = 0; test < 12; ++test)
    EXPECT_EQ(memory_.judge(none_but_near, kNow, {}).wear, WearLevel::plan) << "held, and not made worse either";
  for (int test = 0; test < 3; ++test)
    EXPECT_EQ(memory_.judge({.wear = WearLevel::none}, kNow, {}).wear, WearLevel::plan);
  EXPECT_EQ(memory_.judge({.wear = WearLevel::none}, kNow, {}).wear, WearLevel::none);
}

TEST(VerdictWords, AreThoseOfTheOperator) {
  const TestVerdict verdict{.wear = WearLevel::book_at_once, .replace_by = day("2017-06-01")};
  EXPECT_EQ(in_words(verdict, {.wear = WearLevel::book, .replace_by = day("2019-06-01")}),
            "this test alone says: book a vessel at once; replacement by 2017-06-01; instruments trusted; stroke done. "
            "The advice rests on all tests so far; together they say: book a vessel; replacement by 2019-06-01; "
            "instruments trusted; stroke done");
  EXPECT_EQ(
      in_words({.wear = WearLevel::none}, {}),
      "this test alone says: no work yet; instruments trusted; stroke done. The advice rests on all tests so far; "
      "together they say the same");
}

TEST(VerdictWords, OfOlderJournalsAreReadToo) {
  const auto record = from_words(
      "what this test by itself says: no work (were the work one campaign earlier: plan the work), the seal replaced "
      "by "
      "2017-06-01, instruments doubted, stroke done; what is in force after all tests so far: plan the work, no date "
      "yet, "
      "instruments trusted, stroke failed");
  ASSERT_TRUE(record);
  EXPECT_EQ(record->verdict, (TestVerdict{.wear = WearLevel::none,
                                          .wear_a_campaign_earlier = WearLevel::plan,
                                          .replace_by = day("2017-06-01"),
                                          .instruments_doubted = true}));
  EXPECT_EQ(record->in_force, (InForce{.wear = WearLevel::plan, .failing = true}));
  const auto later = from_words(
      "this test alone says: plan the work; the seal replaced by 2017-06-01; instruments trusted; stroke done. The "
      "advice goes by all tests so far, which say the same");
  ASSERT_TRUE(later);
  EXPECT_EQ(later->in_force, (InForce{.wear = WearLevel::plan, .replace_by = day("2017-06-01")}));
  const auto released = from_words(
      "this test alone says: no work yet (were the work one campaign earlier: plan the work); instruments trusted; "
      "stroke done. The advice goes by all tests so far, which say: plan the work; instruments trusted; stroke failed");
  ASSERT_TRUE(released);
  EXPECT_EQ(released->verdict.wear_a_campaign_earlier, WearLevel::plan);
  EXPECT_EQ(released->in_force, (InForce{.wear = WearLevel::plan, .failing = true}));
}

TEST(VerdictWords, OtherReasonsAreNoRecord) {
  EXPECT_FALSE(from_words(""));
  EXPECT_FALSE(from_words("health grade 0.7"));
  EXPECT_FALSE(from_words("what this test by itself says: ; what is in force after all tests so far: "));
  EXPECT_FALSE(from_words("this test alone says: . The advice rests on all tests so far; together they say"));
  EXPECT_FALSE(from_words(
      "this test alone says: no work yet. The advice rests on all tests so far; together they say the same"));
}

}  // namespace
}  // namespace sealwatch::advisory_generation

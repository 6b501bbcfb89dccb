// Which acts of `sealwatch retract` mean nothing, by what is known of the asset's tests.
#include "services/cli/retraction_effect.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sealwatch/message/retraction.hpp"

namespace sealwatch::cli {
namespace {

using ::testing::HasSubstr;

class RetractionEffect : public ::testing::Test {
 protected:
  static constexpr const char* kMarch = "XT03/MV2-20090301T000000Z-1a2b3c4d";
  static constexpr const char* kApril = "XT03_MV2-20090401T000000Z-5e6f7a8b";
  inline static const std::string kElsewhere = "retraction/XT03/MV2/since/2009-02-01T00:00:00Z/2010-01-02T00:00:00Z";
  inline static const std::string kTaken = "retraction/XT03/MV2/since/2009-03-01T00:00:00Z/2010-01-01T00:00:00Z";

  static RetractOptions options() {
    RetractOptions made;
    made.asset_id = "XT03/MV2";
    return made;
  }
  static RetractOptions test(const std::string& pst_id) {
    RetractOptions made = options();
    made.pst_id = pst_id;
    return made;
  }
  static RetractOptions since(const std::string& time) {
    RetractOptions made = options();
    made.since = time;
    return made;
  }
  static RetractOptions withdraw(const std::string& id) {
    RetractOptions made = options();
    made.withdraw = id;
    return made;
  }

  static RemainingLife life(const std::vector<std::string>& tests) {
    RemainingLife made;
    made.asset_id = "XT03/MV2";
    for (const std::string& pst_id : tests) made.header.source_ids.push_back("leakage_estimate/" + pst_id);
    made.tests_since_replacement = static_cast<std::int32_t>(tests.size());
    return made;
  }

  static std::string said(const std::optional<Error>& error) { return error ? error->describe() : ""; }
};

TEST_F(RetractionEffect, ATestOfAnotherAssetIsNone) {
  const KnownTests nothing;
  EXPECT_THAT(said(objection(nothing, test("NOSUCH"))), HasSubstr("'NOSUCH': is not a test of XT03/MV2"));
  EXPECT_THAT(said(objection(nothing, test(kMarch))), HasSubstr("whose ids begin with 'XT03_MV2-'"));
  EXPECT_EQ(said(objection(nothing, test(kApril))), "") << "it may be one that prognosis does not know yet";
}

TEST_F(RetractionEffect, WhatTheJournalsDoNotKnowIsNotSent) {
  const KnownTests known{.complete = true,
                         .tests = {{kApril, parse_utc("2009-04-01").value()}, {"XT03_MV2-undated-1", std::nullopt}},
                         .in_force = {kTaken},
                         .life = {}};
  EXPECT_EQ(said(objection(known, test(kApril))), "");
  EXPECT_THAT(said(objection(known, test("XT03_MV2-20090401T000000Z-5e6f7a8c"))),
              HasSubstr("that the services know; did you mean '" + std::string(kApril)));
  EXPECT_EQ(said(objection(known, since("2009-04-02"))), "") << "tests that were set aside are not among them";
  EXPECT_EQ(said(objection(known, withdraw(kTaken))), "");
  EXPECT_THAT(said(objection(known, withdraw("cmms-4711"))),
              HasSubstr("is neither a retraction nor a replacement of XT03/MV2 in force"));
  EXPECT_EQ(said(objection(known, withdraw(kElsewhere))), "") << "another service may hold it still";
}

TEST_F(RetractionEffect, WithoutThemTheAnswerTellsWhetherAnythingChanged) {
  KnownTests known{.life = life({kApril})};
  EXPECT_THAT(said(objection(known, life({kApril}), since("2031-01-01"))), HasSubstr("received, and changes nothing"));
  EXPECT_EQ(said(objection(known, life({}), test(kApril))), "");
  known.complete = true;
  known.in_force = {kTaken};
  EXPECT_THAT(said(objection(known, life({kApril}), since("2031-01-01"))), HasSubstr("received, and changes nothing"));
  EXPECT_THAT(said(objection(known, life({kApril}), withdraw(kElsewhere))), HasSubstr("changes nothing"));
  EXPECT_EQ(said(objection(known, life({kApril}), withdraw(kTaken))), "") << "another layer counts its tests";
  EXPECT_EQ(said(objection({}, life({kApril}), since("2031-01-01"))), "") << "nothing to compare with";
}

/// What was sent again to somebody else was the last that was heard right after a replay.
TEST_F(RetractionEffect, TheAnswerIsHeldAgainstWhatStoodLastBeforeIt) {
  KnownTests known{.life = life({kMarch})};
  std::optional<RemainingLife> answer;
  RemainingLife without_april = life({kMarch});
  without_april.header.source_ids.push_back(kTaken);
  RemainingLife later = life({kApril});
  for (const RemainingLife& heard : {life({kMarch}), life({kMarch, kApril}), without_april, later})
    hear(heard, kTaken, known, answer);
  ASSERT_EQ(answer, without_april);
  EXPECT_EQ(said(objection(known, *answer, test(kApril))), "");
  known.life = without_april;
  EXPECT_THAT(said(objection(known, *answer, test(kApril))), HasSubstr("changes nothing"));
}

}  // namespace
}  // namespace sealwatch::cli

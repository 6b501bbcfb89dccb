// Which messages a service takes in, and what it says of the others.
#include "services/common/runtime/admission.hpp"

#include <gmock/gmock.h>
#include <malloc.h>

#include <chrono>
#include <limits>
#include <map>
#include <string>
#include <string_view>

#include "sealwatch/message/retraction.hpp"

namespace sealwatch {
namespace {

using ::testing::HasSubstr;

const UtcTime kNow = parse_utc("2031-04-12T03:00:00Z").value();

RawSamples live_test(const std::string& start) {
  RawSamples raw;
  raw.asset_id = "XT03-MV2";
  raw.source_id = "mcs";
  raw.recording_id = "april";
  raw.start_time_known = true;
  raw.start_time_ns = parse_utc(start).value().nanoseconds;
  return raw;
}

std::string refusal(const Message& message, const Admission& admission = Admission()) {
  return admission.refusal(message, kNow).value_or("");
}

TEST(AdmissionOfDates, ALiveTestOfTheFutureIsRefusedAlsoTheFirst) {
  EXPECT_EQ(refusal(live_test("2031-04-12T20:00:00Z")), "") << "clocks differ";
  EXPECT_THAT(refusal(live_test("2031-04-14T00:00:00Z")),
              HasSubstr("recording april of XT03-MV2: its start time, 2031-04-14T00:00:00Z, lies in the future"));
  Admission admission;
  admission.note(live_test("2031-04-10T00:00:00Z"));
  EXPECT_THAT(refusal(live_test("2031-04-14T00:00:00Z"), admission), HasSubstr("set the sender's clock"));
}

TEST(AdmissionOfDates, WhatIsPlayedBackMayBeOfAnotherTime) {
  RawSamples played = live_test("2051-04-14T00:00:00Z");
  played.header.replay = true;
  EXPECT_EQ(refusal(played), "");
  Admission admission;
  RawSamples earlier = live_test("2031-03-10T00:00:00Z");
  earlier.header.replay = true;
  admission.note(earlier);
  EXPECT_THAT(refusal(played, admission), HasSubstr("more than a year after the asset's newest test"));
  played.start_time_ns = parse_utc("2032-03-01T00:00:00Z").value().nanoseconds;
  EXPECT_EQ(refusal(played, admission), "");
  admission.note(live_test("2031-03-20T00:00:00Z"));
  EXPECT_THAT(refusal(played, admission), HasSubstr("lies in the future (it is now 2031-04-12T03:00:00Z), and the "
                                                    "asset has live tests"))
      << "step by step it would lead anywhere";
}

/// A test that a service, or who forges its name, speaks of.
template <class Content>
Content said_of_test(const std::string& time, const std::string& pst_id = "XT03-MV2-forged") {
  Content message;
  message.asset_id = "XT03-MV2";
  message.header.pst_id = pst_id;
  message.header.event_time_known = true;
  message.header.event_time_ns = parse_utc(time).value().nanoseconds;
  return message;
}

template <class Content>
class AdmissionOfDatesOf : public ::testing::Test {};
using SaidOfTests = ::testing::Types<SampleBlock, TestWindow, TestFeatures, StateReport, HealthReport, LeakageEstimate,
                                     RemainingLife, ModelDiscrepancy>;
TYPED_TEST_SUITE(AdmissionOfDatesOf, SaidOfTests);

TYPED_TEST(AdmissionOfDatesOf, EveryLayerAFutureOneIsRefused) {
  EXPECT_EQ(refusal(said_of_test<TypeParam>("2031-04-12T20:00:00Z")), "") << "clocks differ";
  TypeParam forged = said_of_test<TypeParam>("2051-04-14T00:00:00Z");
  EXPECT_THAT(refusal(forged), HasSubstr("test XT03-MV2-forged of XT03-MV2: its time, 2051-04-14T00:00:00Z, lies in "
                                         "the future (it is now 2031-04-12T03:00:00Z); set the sender's clock"));
  EXPECT_EQ(refusal(said_of_test<TypeParam>("2051-04-14T00:00:00Z", "XT03-MV2-bench-simulated")), "");
  forged.header.replay = true;
  EXPECT_EQ(refusal(forged), "") << "a history that is played back may be of any time";
  Admission admission;
  admission.note(said_of_test<TypeParam>("2031-03-10T00:00:00Z"));
  EXPECT_THAT(refusal(forged, admission), HasSubstr("the asset has live tests"));
  Admission restarted;
  restarted.note(said_of_test<TypeParam>("2031-03-10T00:00:00Z"));
  EXPECT_EQ(refusal(said_of_test<TypeParam>("1995-04-14T00:00:00Z"), restarted), "");
}

TEST(AdmissionOfDates, AClockThatIsNotSetRefusesNothing) {
  const UtcTime boot = parse_utc("1970-01-01T00:00:40Z").value();
  EXPECT_FALSE(Admission().refusal(live_test("2031-04-12T02:00:00Z"), boot));
  EXPECT_FALSE(Admission().refusal(said_of_test<TestFeatures>("2031-04-12T02:00:00Z"), boot));
  EXPECT_FALSE(Admission().refusal(said_of_test<StateReport>("2031-04-12T02:00:00Z", ""), boot));
}

TEST(AdmissionOfDates, OfTestsFromWhichNothingIsConcludedTheNewestDateIsEnough) {
  Admission admission;
  std::size_t halfway = 0;
  for (int k = 0; k < 100'000; ++k) {
    StateReport forged = said_of_test<StateReport>("2031-01-01T00:00:00Z", "forged-" + std::to_string(k));
    forged.header.event_time_ns += k;
    admission.note(forged, false);
    if (k == 50'000) halfway = ::mallinfo2().uordblks;
  }
  EXPECT_LT(::mallinfo2().uordblks, halfway + 100'000);
}

TEST(AdmissionOfDates, NorIsATestOverdueInTheFuture) {
  StateReport overdue = said_of_test<StateReport>("2051-04-14T00:00:00Z", "");
  EXPECT_THAT(refusal(overdue), HasSubstr("its time, 2051-04-14T00:00:00Z, lies in the future"));
  overdue.header.source_ids = {"retraction/XT03-MV2/test/x/2031-04-12T03:00:00Z"};
  EXPECT_EQ(refusal(overdue), "") << "that speaks of the tests that count, of whatever time";
}

TEST(AdmissionOfDates, NoTestIsOlderThanItsAsset) {
  const Admission admission({{"XT03-MV2", parse_utc("2029-01-01").value()}});
  EXPECT_EQ(refusal(live_test("2029-01-02T00:00:00Z"), admission), "");
  EXPECT_THAT(refusal(live_test("2028-12-31T00:00:00Z"), admission),
              HasSubstr("lies before the asset was commissioned, 2029-01-01T00:00:00Z; correct the start time"));
}

TEST(AdmissionOfDates, ATimeThatCannotBeCountedWithIsNone) {
  for (const std::int64_t wild :
       {std::numeric_limits<std::int64_t>::max(), std::numeric_limits<std::int64_t>::min(), std::int64_t{-1}}) {
    RawSamples raw = live_test("2031-04-10T00:00:00Z");
    raw.start_time_ns = wild;
    EXPECT_THAT(refusal(raw), HasSubstr("is not between 1970 and 2260"));
    MaintenanceEvent event;
    event.header.event_time_known = true;
    event.header.event_time_ns = wild;
    EXPECT_THAT(refusal(event), HasSubstr("is not between 1970 and 2260"));
  }
  EXPECT_THAT(refusal(live_test("1969-12-31T00:00:00Z")),
              HasSubstr("its start time, 1969-12-31T00:00:00Z, is not between 1970 and 2260; correct it"));
}

RawSamples test_of(const std::string& asset_id) {
  RawSamples raw = live_test("2031-04-10T00:00:00Z");
  raw.asset_id = asset_id;
  return raw;
}

TEST(AdmissionOfAssets, OfThoseNotConfiguredSoManyAreTakenAndThoseStay) {
  Admission admission({}, {.names = {"XT03-MV2"}});
  for (int k = 0; k < 100'000; ++k) {
    const RawSamples raw = test_of("invented-" + std::to_string(k));
    const auto refused = admission.refusal_of_asset(raw);
    ASSERT_EQ(refused.has_value(), k >= 64) << k;
    if (!refused) admission.note(raw);
  }
  EXPECT_FALSE(admission.refusal_of_asset(test_of("XT03-MV2"))) << "a configured one always";
  EXPECT_FALSE(admission.refusal_of_asset(test_of("invented-63")));
  EXPECT_FALSE(admission.refusal_of_asset(test_of("")));
  EXPECT_EQ(admission.refusal_of_asset(test_of("new\x1B[2J")),
            "asset 'new\\x1B[2J' is not configured, and 64 such assets are there already; give it an asset file, if it "
            "is yours, or find out who sends it");
}

/// What has run so for years has a history.
TEST(AdmissionOfAssets, ThoseThatAreAlikeInTheIdsOfTheirTestsAreTakenAndToldOnce) {
  Admission admission({}, {.names = {"Ventil-\u00C4", "Ventil-\u00D6", "XT_1"}});
  const auto told = admission.take_alike();
  ASSERT_EQ(told.size(), 1U);
  EXPECT_THAT(told[0], HasSubstr("asset 'Ventil-\u00D6': all but ASCII letters"));
  EXPECT_THAT(told[0], HasSubstr("as of 'Ventil-\u00C4': two that begin at the same time"));
  for (const char* asset_id : {"XT 1", "XT 1", "XT/2", "XT 3"}) {
    EXPECT_FALSE(admission.refusal_of_asset(test_of(asset_id)));
    admission.note(test_of(asset_id));
  }
  EXPECT_EQ(admission.take_alike().size(), 1U);
  EXPECT_TRUE(admission.take_alike().empty());
}

TEST(AdmissionOfAssets, OrNoneAtAll) {
  Admission admission({}, {.names = {"XT03-MV2"}, .refuses_others = true});
  admission.note(test_of("old"));
  EXPECT_FALSE(admission.refusal_of_asset(test_of("XT03-MV2")));
  EXPECT_THAT(admission.refusal_of_asset(test_of("old")).value_or(""), HasSubstr("unknown_assets are refused"));
}

TEST(AdmissionOfTexts, AnIdIsOneVisibleLineAndAllTextIsUtf8) {
  RawSamples raw = live_test("2031-04-10T00:00:00Z");
  raw.asset_id = "XT03\x1B[2J";
  EXPECT_EQ(refusal(raw),
            "its asset_id, 'XT03\\x1B[2J', has control or invisible characters; send it with a plain name");
  raw = live_test("2031-04-10T00:00:00Z");
  raw.asset_id = "XT03\u200b";
  EXPECT_THAT(refusal(raw), HasSubstr("'XT03\\xE2\\x80\\x8B', has control or invisible characters"));
  raw = live_test("2031-04-10T00:00:00Z");
  for (const auto& [id, rule] :
       std::map<std::string, std::string>{{"XT03 ", "'XT03 ', must not begin or end with a blank"},
                                          {" XT03", "' XT03', must not begin or end with a blank"},
                                          {"--config=x", "'--config=x', must not begin with '-'"},
                                          {std::string(81, 'x'), "must not be longer than 80 bytes"}}) {
    raw.asset_id = id;
    EXPECT_THAT(refusal(raw), HasSubstr("its asset_id")) << id;
    EXPECT_THAT(refusal(raw), HasSubstr(rule));
  }
  raw = live_test("2031-04-10T00:00:00Z");
  raw.recording_id = "one\ntwo";
  EXPECT_THAT(refusal(raw), HasSubstr("recording_id"));
  raw.recording_id = std::string(501, 'x');
  EXPECT_THAT(refusal(raw), HasSubstr("longer than 500 bytes"));
  raw.recording_id = "caf\xE9";
  EXPECT_THAT(refusal(raw), HasSubstr("is not UTF-8"));
  raw = live_test("2031-04-10T00:00:00Z");
  raw.header.source_ids = {"good", "bad\x07"};
  EXPECT_THAT(refusal(raw), HasSubstr("its source_ids, 'bad\\x07', has"));
  raw = live_test("2031-04-10T00:00:00Z");
  raw.samples.channels = {{"flow\x1b[31m", "m3/s", 0.0, {}}};
  EXPECT_THAT(refusal(raw), HasSubstr("its name, 'flow\\x1B[31m', has"));
  raw.samples.channels = {{"flow", "m3/s\u202e", 0.0, {}}};
  EXPECT_THAT(refusal(raw), HasSubstr("its unit, 'm3/s\\xE2\\x80\\xAE', has"));
  raw.samples.channels = {{"flow", "m3/s", 0.0, {}}};
  EXPECT_EQ(refusal(raw), "");
  raw.test_kind = "pst\n";
  EXPECT_THAT(refusal(raw), HasSubstr("test_kind"));
  Acknowledgement seen;
  seen.advisory_id = "recommendation/XT03";
  seen.remark = "two\nlines";
  EXPECT_EQ(refusal(seen), "");
  seen.remark = std::string(4001, 'x');
  EXPECT_THAT(refusal(seen), HasSubstr("its remark is longer than 4000 bytes"));
  seen.remark.clear();
  seen.advisory_id = std::string(501, '\x01');
  EXPECT_THAT(refusal(seen), HasSubstr("its advisory_id is longer than 500 bytes")) << "and not all of it";
  seen.advisory_id = "a";
  seen.remark = "\xFF";
  EXPECT_THAT(refusal(seen), HasSubstr("its remark, '\\xFF', is not UTF-8"));
}

TEST(AdmissionOfSamples, ABlockOrWindowOfAStrangerKeepsTheLimits) {
  SampleBlock block;
  block.samples = {.time_s = {0.0, 0.1}, .channels = {{"position", "m", 0.0, {0.06, 1e308}}}};
  EXPECT_THAT(refusal(block), HasSubstr("its samples have a number that no sensor gives"));
  block.samples.channels[0].values[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refusal(block), "");
  TestWindow window;
  EXPECT_EQ(refusal(window), "") << "one without rows says why";
  window.samples = block.samples;
  EXPECT_THAT(refusal(window), HasSubstr("no sensor gives"));
  window.samples = {.time_s = {0.0, 5e-12}, .channels = {}};
  EXPECT_THAT(refusal(window), HasSubstr("rows 5e-12 s apart"));
}

TEST(AdmissionOfSamples, ATestOfNoAssetIsRefusedByName) {
  RawSamples block;
  block.recording_id = "april";
  EXPECT_EQ(refusal(block), "recording april: its asset_id is empty; say of which asset it is");
}

TEST(AdmissionOfSamples, BlocksOfATestCountFromZero) {
  RawSamples raw = live_test("2031-04-10T00:00:00Z");
  raw.block_number = std::numeric_limits<std::uint64_t>::max();
  EXPECT_THAT(refusal(raw), HasSubstr("block 18446744073709551615 is not possible"));
}

TEST(AdmissionOfMadeUpTests, TheyDoNotMixWithRecordedOnes) {
  RawSamples made_up = live_test("2031-04-10T00:00:00Z");
  made_up.source_id = "virtual_bench";
  Admission admission;
  SampleBlock block;
  block.asset_id = "XT03-MV2";
  block.source_id = "virtual_bench";
  admission.note(block);
  EXPECT_EQ(refusal(made_up, admission), "");
  block.source_id = "mcs";
  admission.note(block);
  EXPECT_THAT(refusal(made_up, admission), HasSubstr("made up by the virtual bench, it does not belong"));
  EXPECT_EQ(refusal(live_test("2031-04-10T00:00:00Z"), admission), "");
}

TEST(AdmissionOfEvents, OnlyWhatIsKnownIsTakenIn) {
  const auto said = [](const std::string& kind, const std::string& id) {
    MaintenanceEvent event;
    event.asset_id = "XT03-MV2";
    event.kind = kind;
    event.header.message_id = id;
    event.header.event_time_known = true;
    event.header.event_time_ns = kNow.nanoseconds;
    return refusal(event);
  };
  EXPECT_EQ(said("seal_replaced", "maintenance_event/XT03-MV2/2031"), "");
  EXPECT_EQ(said("actuator_replaced", ""), "");
  EXPECT_THAT(said("seal_replace", ""), HasSubstr("its kind, 'seal_replace', is not one of actuator_replaced, "));
  const std::string one = retraction_id("XT03-MV2", kTestRetracted, "XT03-MV2-2031-x", kNow);
  EXPECT_EQ(said("test_retracted", one), "");
  EXPECT_THAT(said("tests_retracted", one), HasSubstr("does not say what is retracted"));
  EXPECT_EQ(said("retraction_withdrawn", retraction_id("XT03-MV2", kRetractionWithdrawn, one, kNow)), "");
  EXPECT_THAT(said("test_retracted", "retraction/XT04/test/x/y"), HasSubstr("does not say what is retracted"));
}

TEST(Admission, ATestThatWasRetractedIsNotTheNewest) {
  Admission admission;
  const auto made = [](const std::string& start) {
    StateReport report;
    report.asset_id = "XT03-MV2";
    report.header.pst_id = "test " + start;
    report.header.event_time_known = true;
    report.header.event_time_ns = parse_utc(start).value().nanoseconds;
    return Message(report);
  };
  MaintenanceEvent replacement;
  replacement.asset_id = "XT03-MV2";
  replacement.kind = "seal_replaced";
  replacement.header.event_time_known = true;
  replacement.header.event_time_ns = parse_utc("2049-01-01T00:00:00Z").value().nanoseconds;
  admission.note(made("2031-01-01T00:00:00Z"));
  admission.note(made("2050-01-01T00:00:00Z"));
  EXPECT_FALSE(admission.refusal(replacement, kNow)) << "it is before the newest test";
  MaintenanceEvent retraction;
  retraction.asset_id = "XT03-MV2";
  retraction.header.message_id = retraction_id("XT03-MV2", kTestRetracted, "test 2050-01-01T00:00:00Z", kNow);
  admission.note(retraction);
  EXPECT_THAT(admission.refusal(replacement, kNow).value_or(""), HasSubstr("lies in the future"));

  Admission restarted;
  restarted.note(made("2050-01-01T00:00:00Z"));
  RemainingLife answer;
  answer.asset_id = "XT03-MV2";
  answer.header.source_ids = {retraction.header.message_id};
  restarted.note(answer);
  EXPECT_TRUE(restarted.refusal(replacement, kNow)) << "what answered the retraction names it";
}

MaintenanceEvent act_on(std::string_view kind, const std::string& what) {
  MaintenanceEvent event;
  event.asset_id = "XT03-MV2";
  event.kind = kind;
  event.header.message_id = retraction_id("XT03-MV2", kind, what, kNow);
  event.header.event_time_known = true;
  event.header.event_time_ns = kNow.nanoseconds;
  return event;
}

TestWindow concluded_test(const std::string& pst_id, bool dated) {
  TestWindow test;
  test.asset_id = "XT03-MV2";
  test.header.pst_id = pst_id;
  test.header.event_time_known = dated;
  test.header.event_time_ns = dated ? kNow.nanoseconds : 0;
  return test;
}

/// Six thousand retractions of tests that are not there filled the journals with forecasts that changed nothing.
TEST(AdmissionOfRetractions, OnlySoManyMayMeanNothing) {
  Admission admission;
  std::size_t taken = 0;
  const auto take = [&](const MaintenanceEvent& event) {
    if (admission.is_ahead(event) || !refusal(event, admission).empty()) return false;
    admission.note(event, false);
    return true;
  };
  for (int k = 0; k < 300; ++k) {
    const std::string number = std::to_string(k);
    taken += take(act_on(kTestRetracted, "XT03-MV2-none" + number));
    taken += take(act_on(kTestsRetracted, "2199-01-01T00:00:00.000000" + std::to_string(100 + k) + "Z"));
    taken += take(act_on(kRetractionWithdrawn, "retraction/XT03-MV2/test/none/" + number));
    taken += take(
        act_on(kRetractionWithdrawn, "maintenance_event/XT03-MV2/seal_replaced/" + number + "/2018-06-10T00:00:00Z"));
  }
  EXPECT_EQ(taken, kMostIdleRetractions);
  EXPECT_TRUE(admission.is_ahead(act_on(kTestRetracted, "XT03-MV2-another"))) << "its test may be on its way";
  const MaintenanceEvent since = act_on(kTestsRetracted, "2199-01-01T00:00:00Z");
  EXPECT_FALSE(admission.is_ahead(since)) << "what is not known is not meant";
  EXPECT_THAT(
      refusal(since, admission),
      HasSubstr("it means no test that is known, and 64 retractions that mean nothing known of asset XT03-MV2"));
  for (const bool dated : {false, true}) {
    const std::string test = dated ? "XT03-MV2-dated" : "XT03-MV2-undated";
    admission.note(concluded_test(test, dated));
    const MaintenanceEvent known = act_on(kTestRetracted, test);
    EXPECT_TRUE(take(known)) << test;
    EXPECT_TRUE(take(act_on(kRetractionWithdrawn, known.header.message_id))) << test;
    EXPECT_FALSE(take(act_on(kRetractionWithdrawn, known.header.message_id))) << "it is withdrawn";
  }
  MaintenanceEvent replaced = act_on("seal_replaced", "");
  replaced.header.message_id = "maintenance_event/XT03-MV2/seal_replaced/true/2018-06-10T00:00:00Z";
  EXPECT_TRUE(take(replaced));
  EXPECT_TRUE(take(act_on(kRetractionWithdrawn, replaced.header.message_id)));
}

/// One test, retracted six thousand times, did the same.
TEST(AdmissionOfRetractions, OfATestThatIsRetractedAlreadyMeanNothing) {
  Admission admission;
  admission.note(concluded_test("XT03-MV2-dated", true));
  std::size_t taken = 0;
  for (int k = 0; k < 300; ++k) {
    MaintenanceEvent again = act_on(kTestRetracted, "XT03-MV2-dated");
    again.header.message_id = retraction_id("XT03-MV2", kTestRetracted, "XT03-MV2-dated", add_seconds(kNow, k));
    MaintenanceEvent since = act_on(kTestsRetracted, format_utc(add_seconds(kNow, -60.0 - k)));
    for (const MaintenanceEvent& event : {again, since})
      if (!admission.is_ahead(event) && refusal(event, admission).empty()) {
        admission.note(event, false);
        ++taken;
      }
  }
  EXPECT_EQ(taken, kMostIdleRetractions + 1);
  admission.note(concluded_test("XT03-MV2-newer", true));
  EXPECT_EQ(refusal(act_on(kTestsRetracted, format_utc(add_seconds(kNow, -1.0))), admission), "");
}

/// What data acquisition has concluded waits here: refused here alone, the retracted test would enter the forecast.
TEST(AdmissionOfRetractions, ATestThatIsNotConcludedYetIsMeantAllTheSame) {
  const auto full = [] {
    Admission admission;
    for (std::size_t k = 0; k < kMostIdleRetractions; ++k)
      admission.note(act_on(kTestRetracted, "XT03-MV2-none" + std::to_string(k)), false);
    EXPECT_TRUE(admission.is_ahead(act_on(kTestRetracted, "XT03-MV2-behind")));
    admission.note(concluded_test("XT03-MV2-behind", true), false);
    return admission;
  };
  Admission one = full();
  const MaintenanceEvent retracted = act_on(kTestRetracted, "XT03-MV2-behind");
  EXPECT_FALSE(one.is_ahead(retracted));
  one.note(retracted, false);
  MaintenanceEvent again = retracted;
  again.header.message_id = retraction_id("XT03-MV2", kTestRetracted, "XT03-MV2-behind", add_seconds(kNow, 1.0));
  EXPECT_TRUE(one.is_ahead(again));
  Admission all = full();
  EXPECT_NE(refusal(act_on(kTestsRetracted, format_utc(add_seconds(kNow, 60.0))), all), "");
  const MaintenanceEvent since = act_on(kTestsRetracted, format_utc(add_seconds(kNow, -60.0)));
  EXPECT_EQ(refusal(since, all), "");
  all.note(since, false);
  EXPECT_NE(refusal(act_on(kTestsRetracted, format_utc(add_seconds(kNow, -61.0))), all), "");
}

/// What a retraction means is looked up, not looked for: a restart applies all there ever were.
TEST(RetractedTests, ManyRetractionsCostNoMoreThanOneEach) {
  RetractedTests tests;
  for (int k = 0; k < 100; ++k) tests.know("test " + std::to_string(k), kNow);
  const auto begin = std::chrono::steady_clock::now();
  for (int k = 0; k < 20'000; ++k) {
    tests.apply({.id = "retraction " + std::to_string(k), .pst_id = "none " + std::to_string(k)});
    for (int test = 0; test < 100; ++test) EXPECT_TRUE(tests.counts("test " + std::to_string(test)));
  }
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20)) << "it took an hour";
}

TEST(RetractedTests, WhatWasWithdrawnHoldsNoMoreWhicheverIsToldFirst) {
  RetractedTests tests;
  tests.know("one", kNow);
  const Retraction first{.id = "first", .pst_id = "one"}, second{.id = "second", .since = kNow};
  Retraction withdrawn{.id = "withdrawn"};
  withdrawn.withdrawn_id = "first";
  tests.apply(first);
  tests.apply(first);
  tests.apply(second);
  EXPECT_FALSE(tests.counts("one"));
  tests.apply(withdrawn);
  EXPECT_FALSE(tests.counts("one")) << "the second holds";
  withdrawn.withdrawn_id = "second";
  tests.apply(withdrawn);
  EXPECT_TRUE(tests.counts("one"));
  tests.apply(second);
  EXPECT_TRUE(tests.counts("one")) << "an answer to it that comes late names it again";
}

}  // namespace
}  // namespace sealwatch

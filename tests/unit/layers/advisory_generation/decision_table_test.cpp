// The decision table of docs/advisories.md, line by line: confirmed situations and what they ask for.
#include <gmock/gmock.h>

#include "services/advisory_generation/recommendation.hpp"
#include "tests/unit/layers/advisory_generation/fixtures.hpp"

namespace sealwatch::advisory_generation {
namespace {

using test::fault;
using test::TestCase;
using testing::HasSubstr;

/// The recommendation once the same has been seen in three tests.
Recommendation confirmed(const TestCase& one) {
  const Configuration configuration = test::configuration();
  const SiteConfig* site = &configuration.sites[0];
  const Assessment assessment = assess(one.evidence(), site, {});
  VerdictMemory memory;
  for (int repeat = 0; repeat < 3; ++repeat) memory.judge(assessment.verdict, one.time(), {});
  return recommend(one.evidence(), assessment, memory.in_force(), site);
}

struct Line {
  const char* situation;
  TestCase test;
  AdvisoryPriority priority;
  AdvisoryAction action;
};

void PrintTo(const Line& line, std::ostream* stream) { *stream << line.situation; }

class DecisionTableTest : public testing::TestWithParam<Line> {};

TEST_P(DecisionTableTest, PriorityAndAction) {
  const Recommendation recommendation = confirmed(GetParam().test);
  EXPECT_EQ(recommendation.priority, GetParam().priority) << recommendation.text;
  EXPECT_EQ(recommendation.action, GetParam().action) << recommendation.text;
  EXPECT_FALSE(recommendation.text.empty());
}

using P = AdvisoryPriority;
using A = AdvisoryAction;
const ProposedFault kSensor = fault(FaultKind::sensor, "sensor:flow", 0.8);
const ProposedFault kSeal = fault(FaultKind::internal_leakage, "piston_seal", 0.7);
const ProposedFault kVague = fault(FaultKind::sensor, "sensor:flow", 0.4);

RegionJudgement residual(Reference reference, AlertRegion region) {
  RegionJudgement judgement;
  judgement.quantity = "residual.pressure_a";
  judgement.reference = reference;
  judgement.region = region;
  return judgement;
}

// Month 24 is 2012-01. With 12 months to book, the last campaign before the P10 end of life decides:
// RUL 90: P10 at 85 months, 2019-01, campaign 2018-06: book by 2017-06, 65 months to go.
// RUL 48: P10 at 43, 2015-07, campaign 2015-06, book by 2014-06: 29 months. RUL 36: campaign 2014-06: 17 months to go.
// RUL 24: P10 at 19, 2013-07, campaign 2013-06: book by 2012-06, 5 months. RUL 14: P10 at 8.9, campaign 2012-06:
// passed.
INSTANTIATE_TEST_SUITE_P(
    Table, DecisionTableTest,
    testing::Values(
        Line{"far end of life", {.rul_months = 90}, P::information, A::none},
        Line{"beyond the planning horizon", {.rul_months = 48}, P::information, A::none},
        Line{"within the planning horizon", {.rul_months = 36}, P::medium, A::plan_replacement},
        Line{"booking due", {.rul_months = 24}, P::high, A::book_vessel},
        Line{"booking date passed", {.rul_months = 14}, P::urgent, A::book_vessel},
        Line{"P10 end of life before the next test", {.rul_months = 6}, P::urgent, A::replace_now},
        Line{"past threshold", {.forecast = ForecastState::past_threshold, .rul_months = 0}, P::urgent, A::replace_now},
        Line{"no significant trend", {.forecast = ForecastState::no_significant_trend}, P::information, A::none},
        Line{"history too short", {.forecast = ForecastState::insufficient_history}, P::information, A::none},
        Line{"test could not be used", {.used = false}, P::low, A::repeat_test},
        Line{"test aborted", {.verdict = PstVerdict::aborted}, P::low, A::repeat_test},
        Line{"test failed repeatedly", {.verdict = PstVerdict::failed}, P::urgent, A::replace_now},
        Line{"test failed repeatedly, booking date passed",
             {.rul_months = 14, .verdict = PstVerdict::failed},
             P::urgent,
             A::replace_now},
        Line{"test failed, sensor doubted",
             {.verdict = PstVerdict::failed, .faults = {kSensor}},
             P::high,
             A::repeat_test},
        Line{"sensor fault", {.faults = {kSensor}}, P::medium, A::inspect_instrumentation},
        Line{"sensor fault is one of many", {.faults = {kVague}}, P::information, A::none},
        Line{"alarm, cause in the actuator",
             {.region = AlertRegion::alarm, .faults = {kSeal}},
             P::medium,
             A::plan_replacement},
        Line{"alarm, cause unknown", {.region = AlertRegion::alarm}, P::information, A::none},
        Line{"residuals in alarm",
             {.region = AlertRegion::alarm, .judgements = {residual(Reference::own_baseline, AlertRegion::alarm)}},
             P::medium,
             A::examine_actuator},
        Line{"residuals in alarm that the accepted model explains",
             {.region = AlertRegion::alarm,
              .judgements = {residual(Reference::own_baseline, AlertRegion::alarm),
                             residual(Reference::accepted_model, AlertRegion::normal)}},
             P::information,
             A::none},
        Line{"residuals in alarm that the accepted model does not explain",
             {.region = AlertRegion::alarm, .judgements = {residual(Reference::accepted_model, AlertRegion::alarm)}},
             P::medium,
             A::examine_actuator},
        Line{"warning is no alarm", {.region = AlertRegion::warning, .faults = {kSeal}}, P::information, A::none},
        Line{"booking outranks a sensor fault", {.rul_months = 24, .faults = {kSensor}}, P::high, A::book_vessel}));

TEST(DecisionTable, NamesTheDoubtedSensorInTheTestsAfterItsFaultToo) {
  const Configuration configuration = test::configuration();
  TestCase frozen;
  frozen.faults = {fault(FaultKind::sensor, "sensor:position", 0.9)};
  const TestCase in_order{.month = 25.0};
  VerdictMemory memory;
  const auto play = [&](const TestCase& one) {
    const Assessment assessment = assess(one.evidence(), &configuration.sites[0], {});
    (void)memory.judge(assessment.verdict, one.time(), {});
    return recommend(one.evidence(), assessment, memory.in_force(), &configuration.sites[0]);
  };
  for (int repeat = 0; repeat < 3; ++repeat) (void)play(frozen);
  for (int repeat = 0; repeat < 3; ++repeat) {
    const Recommendation after = play(in_order);
    EXPECT_EQ(after.action, AdvisoryAction::inspect_instrumentation);
    EXPECT_EQ(after.text, "Inspect the instrumentation: doubted in the last tests: position.");
  }
  EXPECT_EQ(play(in_order).action, AdvisoryAction::none);
}

TEST(DecisionTable, SaysWhatBecameOfAChannelThatIsMissed) {
  const auto reason = [](const std::string& fate) {
    Evidence evidence = TestCase{}.evidence();
    evidence.state.stale_channels = {"velocity"};
    if (!fate.empty()) evidence.state.verdict_reasons = {"judged by the position", fate};
    const Assessment assessment = assess(evidence, nullptr, {});
    EXPECT_EQ(assessment.verdict.doubted_channels, std::set<std::string>{"velocity"});
    return assessment.instruments_reason;
  };
  const std::string known = "channel velocity, OK in most earlier tests, ";
  for (const char* fate : {"was not recorded", "is UNKNOWN: gaps", "is FAILED: frozen for 4.0 s"})
    EXPECT_EQ(reason(known + fate), known + fate);
  EXPECT_EQ(reason(""), "channel velocity was OK in most earlier tests and is not in this one");
}

TEST(DecisionTable, SaysWhatBookByWhenAndWhy) {
  const Recommendation r = confirmed({.rul_months = 24});
  EXPECT_EQ(format_date(*r.work_before), "2013-06-01");
  EXPECT_EQ(format_date(*r.latest_by), "2012-05-31");  // twelve mean months before
  EXPECT_THAT(
      r.text,
      HasSubstr("Book a vessel by 2012-05-31 to replace the piston seal in campaign summer 2013 (2013-06-01)."));
  EXPECT_THAT(r.text, HasSubstr("expected on 2013-12-31 (80 %: 2013-07-28 to 2014-06-06)"));
}

TEST(DecisionTable, CampaignKeepsTheFailureProbabilityDown) {
  // End of life 2014-01 +- 4 months: summer 2013 is at 4 %, summer 2014 at 90 %.
  const TestCase one{.rul_months = 24};
  const std::vector<FailureProbability> campaigns = one.life().forecasts[0].failure_probability;
  ASSERT_FALSE(campaigns.empty());
  for (const FailureProbability& campaign : campaigns)
    EXPECT_EQ(campaign.probability <= Options{}.largest_failure_probability,
              campaign.before_ns <= confirmed(one).work_before->nanoseconds)
        << campaign.label;
}

TEST(DecisionTable, WithoutKnownCampaignsTheEarlyEndOfLifeDecides) {
  const TestCase one{.rul_months = 24};
  Evidence evidence = one.evidence();
  evidence.life.forecasts[0].failure_probability.clear();
  const Assessment assessment = assess(evidence, nullptr, {});
  EXPECT_EQ(*assessment.verdict.replace_by,
            start_of_day(add_months(one.time(), one.life().forecasts[0].rul_p10_months)));
  EXPECT_EQ(assessment.verdict.wear, WearLevel::plan);  // 19 months, 12 of them to book
}

TEST(DecisionTable, LastKnownCampaignLongBeforeTheEndIsNotTheLastOne) {
  const TestCase one{.rul_months = 90};
  Evidence evidence = one.evidence();
  auto& campaigns = evidence.life.forecasts[0].failure_probability;
  campaigns.erase(campaigns.begin() + 2, campaigns.end());  // nothing known after summer 2013
  EXPECT_EQ(assess(evidence, nullptr, {}).verdict.wear, WearLevel::none);
}

TEST(DecisionTable, NoVesselIsBookedWhileTheLawsOfAgeingDiffer) {
  const TestCase one{.rul_months = 24};
  Evidence evidence = one.evidence();
  Forecast logarithmic = evidence.life.forecasts[0];
  logarithmic.method = "ols_log_time";
  logarithmic.rul_p50_months = 24 + 23;  // within largest_law_gap_months
  evidence.life.forecasts.push_back(logarithmic);
  EXPECT_EQ(assess(evidence, nullptr, {}).verdict.wear, WearLevel::book);
  evidence.life.forecasts[1].rul_p50_months = 24 + 25;
  const Assessment apart = assess(evidence, nullptr, {});
  EXPECT_EQ(apart.verdict.wear, WearLevel::plan);
  EXPECT_FALSE(apart.verdict.replace_by);
  VerdictMemory memory;
  for (int repeat = 0; repeat < 2; ++repeat) memory.judge(apart.verdict, one.time(), {});
  EXPECT_THAT(recommend(evidence, apart, memory.in_force(), nullptr).text, HasSubstr("too early for a date"));
}

/// The test of today was left out: the last that counts was still above the limit, the forecast is below by now.
TEST(DecisionTable, APassedLimitThatTheForecastSawIsNotSaidOfAHealthyCondition) {
  const TestCase one{.forecast = ForecastState::past_threshold, .rul_months = 0, .used = false};
  Evidence evidence = one.evidence();
  evidence.life.condition_known = true;
  evidence.life.threshold = 0.6;
  evidence.life.condition = 0.61;
  const auto text = [&] {
    return recommend(evidence, assess(evidence, nullptr, {}), {.wear = WearLevel::replace}, nullptr).text;
  };
  EXPECT_THAT(text(), HasSubstr("by now the limit is passed, so the forecast"));
  evidence.life.condition = 0.59;
  EXPECT_THAT(text(), HasSubstr(": the limit is passed."));
}

TEST(DecisionTable, ABookingDateThatHasPassedIsUrgentWhateverTheRememberedLevel) {
  const TestCase one{.rul_months = 24};
  const Evidence evidence = one.evidence();
  const Assessment assessment = assess(evidence, nullptr, {});
  const UtcTime past_booking = add_months(one.time(), 3.0);  // the lead time is longer than three months
  const Recommendation booked =
      recommend(evidence, assessment, {.wear = WearLevel::book, .replace_by = past_booking}, nullptr);
  EXPECT_EQ(booked.priority, AdvisoryPriority::urgent) << booked.text;
  const Recommendation planned =
      recommend(evidence, assessment, {.wear = WearLevel::plan, .replace_by = past_booking}, nullptr);
  EXPECT_EQ(planned.priority, AdvisoryPriority::medium) << planned.text;
  EXPECT_FALSE(planned.latest_by.has_value()) << "no day in the past is named";
}

TEST(DecisionTable, DatesSayWhereTheyComeFrom) {
  const Configuration configuration = test::configuration();
  const SiteConfig& site = configuration.sites[0];
  const Recommendation r = confirmed({.rul_months = 24});
  const TestVerdict same{.replace_by = r.work_before};
  const InForce in_force{.wear = WearLevel::book, .replace_by = r.work_before};
  const auto alone = reasons_of_dates(r, same, in_force, &site, {});
  ASSERT_EQ(alone.size(), 1u) << "nothing is held";
  EXPECT_THAT(alone[0], HasSubstr("latest by " + format_date(*r.latest_by) + ": 12 months before the work by " +
                                  format_date(*r.work_before)));
  const UtcTime later = start_of_day(add_months(*r.work_before, 24.0));
  const auto held = reasons_of_dates(r, {.replace_by = later}, in_force, &site, {});
  ASSERT_EQ(held.size(), 2u);
  EXPECT_THAT(held[1], HasSubstr("is held, although this test alone says " + format_date(later)));
  EXPECT_TRUE(reasons_of_dates(confirmed({.rul_months = 90}), same, in_force, &site, {}).empty()) << "no work, no date";
}

TEST(DecisionTable, LessUrgentCallsStandInTheReasons) {
  const Recommendation r = confirmed({.rul_months = 24, .faults = {kSensor}});
  ASSERT_EQ(r.also.size(), 1u);
  EXPECT_THAT(r.also[0], HasSubstr("also: Inspect the instrumentation: sensor of flow"));
}

TEST(DecisionTable, OptionsAreChecked) {
  EXPECT_TRUE(Options{}.validate());
  EXPECT_FALSE((Options{.largest_failure_probability = 0.0}).validate());
  EXPECT_FALSE((Options{.booking_horizon_months = 20.0}).validate());
  EXPECT_FALSE((Options{.confirming_tests = 4}).validate());
  EXPECT_FALSE((Options{.easing_tests = 2}).validate());
  EXPECT_FALSE((Options{.date_tolerance_share = 1.0}).validate());
}

}  // namespace
}  // namespace sealwatch::advisory_generation

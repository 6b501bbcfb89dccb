#include "services/cli/summary.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sealwatch/core/time.hpp"
#include "services/cli/forecast_text.hpp"

namespace sealwatch::cli {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

Header header_of_test(const std::string& date) {
  Header header;
  header.pst_id = "A-" + date;
  header.event_time_known = true;
  header.event_time_ns = parse_utc(date).value().nanoseconds;
  return header;
}

Forecast forecast_of(double months) {
  Forecast forecast;
  forecast.method = "ols";
  forecast.window_months = 36;
  forecast.state = ForecastState::ok;
  forecast.rul_months = forecast.rul_p50_months = months;
  forecast.interval_95_low_months = months - 2.0;
  forecast.interval_95_high_months = months + 3.0;
  forecast.failure_probability = {
      {.before_ns = parse_utc("2031-06-01").value().nanoseconds, .label = "summer", .probability = 0.25}};
  return forecast;
}

TEST(OneLine, SaysWhatMattersWithUnits) {
  LeakageEstimate estimate;
  estimate.asset_id = "A";
  estimate.header = header_of_test("2031-04-12");
  estimate.estimated = true;
  estimate.resistance_Pa_s_m3 = 1.0e13;
  estimate.resistance_std_Pa_s_m3 = 2.0e11;
  estimate.used_for_forecast = true;
  EXPECT_EQ(one_line(Message(estimate)), "2031-04-12  A  leakage_estimate  R_CL (10.00 ± 0.20)·10¹² Pa·s/m³");
  estimate.header.clock_quality = ClockQuality::stepped;
  EXPECT_THAT(one_line(Message(estimate)), ::testing::EndsWith("Pa·s/m³ [clock of its sender: stepped]"));
  estimate.header.replay = true;
  EXPECT_THAT(one_line(Message(estimate)), ::testing::EndsWith("Pa·s/m³")) << "dated by the recording";
  estimate.header.replay = false;
  estimate.header.clock_quality = ClockQuality::synchronised;
  EXPECT_THAT(one_line(Message(estimate)), ::testing::EndsWith("Pa·s/m³"));
  estimate.estimated = false;
  estimate.reasons = {"cut"};
  EXPECT_THAT(one_line(Message(estimate)), HasSubstr("no estimate: cut"));
}

TEST(OneLine, FeaturesAreWrittenAsPagesWriteThem) {
  TestFeatures features;
  features.features = {{.name = "travel", .unit = "m", .value = 0.016},
                       {.name = "running_pressure_out", .unit = "Pa", .value = 8.79e6},
                       {.name = "leakage_resistance", .unit = "Pa s/m3", .value = 2.23e13},
                       {.name = "drive_saturation", .unit = "1", .value = 0.0}};
  EXPECT_THAT(one_line(Message(features)),
              HasSubstr("  travel 16.0 mm, running pressure out 87.9 bar, leakage resistance 2.23·10¹³ Pa·s/m³, drive "
                        "saturation 0"));
}

TEST(ForecastTable, ShowsNumbersOnlyWhereThereIsAForecast) {
  Forecast none;
  none.method = "ols";
  none.window_months = 48;
  none.state = ForecastState::insufficient_history;
  none.explanation = "12 of 24 tests";
  const std::string table = forecast_table({forecast_of(18.0), none});
  EXPECT_THAT(table, HasSubstr("18.0"));
  EXPECT_THAT(table, HasSubstr("16.0 .. 21.0"));
  EXPECT_THAT(table, HasSubstr("insufficient history: 12 of 24 tests"));
  EXPECT_THAT(table, HasSubstr("before summer, 2031-06-01: 25 %"));
}

RemainingLife scored(int forecasts, int within_80, int within_95, double confidence = 0.9) {
  RemainingLife life;
  life.scored_forecasts = forecasts;
  life.coverage_80 = static_cast<double>(within_80) / forecasts;
  life.coverage_95 = static_cast<double>(within_95) / forecasts;
  life.confidence = confidence;
  return life;
}

// P(at most 4 of 8 at 80 %) = 5.6 %, P(at most 3 of 8) = 1.0 %, P(at most 5 of 8) = 20.3 %; P(at most 6 of 8 at 95 %) =
// 5.7 %, P(at most 5 of 8) = 0.6 %.
TEST(ScoredLine, JudgesWhereTheFiguresBearIt) {
  EXPECT_EQ(scored_line(scored(8, 4, 8)),
            "  scored           of the last 8 forecasts (3 months ahead), 4 held within their 80 % interval, 8 within "
            "95 %: few, but that may be chance\n");
  EXPECT_THAT(scored_line(scored(8, 3, 8)), HasSubstr("95 %: too few, the intervals are too narrow"));
  EXPECT_THAT(scored_line(scored(8, 5, 8)), HasSubstr("95 %: as expected"));
  EXPECT_THAT(scored_line(scored(8, 5, 6)), HasSubstr("95 %: few, but that may be chance"));
  EXPECT_THAT(scored_line(scored(8, 5, 5)), HasSubstr("95 %: too few"));
  EXPECT_THAT(scored_line(scored(8, 8, 8)), HasSubstr("as expected"));
  EXPECT_THAT(scored_line(scored(4, 1, 4)), HasSubstr("4 within 95 %\n")) << "four tell nothing";
  EXPECT_THAT(scored_line(scored(8, 8, 8, 0.4)), HasSubstr("95 %; the forecaster has probably drifted\n"));
  EXPECT_EQ(scored_line({}), "");
}

DecisionOption option_of(const std::string& label, const std::string& day, double probability, double cost) {
  return {.label = label,
          .at_ns = parse_utc(day).value().nanoseconds,
          .failure_probability = probability,
          .cost_known = true,
          .expected_cost = cost,
          .currency = "MNOK"};
}

// Twenty marks stand for certain failure and for the dearest row: 74 MNOK, so that 12 MNOK are 3.2 marks.
TEST(DecisionChart, DrawsProbabilitiesOutOfOneAndCostsOutOfTheDearest) {
  std::vector<DecisionOption> decision = {option_of("now", "2031-04-12", 0.001, 12.0),
                                          option_of("vår 2032", "2032-06-01", 0.25, 9.25),
                                          option_of("wait for failure", "2033-01-20", 1.0, 74.0)};
  decision[1].cheapest = true;
  EXPECT_EQ("\n" + decision_chart(decision), R"(
  decision         replacement                                fails before                  expected cost, MNOK
                   now               2031-04-12  0.1 %        |.                   |  12.0  |###                 |
                   vår 2032          2032-06-01  25 %         |#####               |  9.25  |###                 |  cheapest
                   wait for failure  2033-01-20  over 99.9 %  |####################|  74.0  |####################|
)");
  for (DecisionOption& option : decision) option.currency.clear();
  EXPECT_THAT(decision_chart(decision), HasSubstr("expected cost\n"));
  decision[2].cost_known = false;
  EXPECT_EQ(decision_chart(decision), "");
  EXPECT_EQ(decision_chart({}), "");
}

TEST(DecisionChart, NeedsNoCostAboveZero) {
  EXPECT_THAT(decision_chart({option_of("now", "2031-04-12", 0.0, 0.0)}), HasSubstr("|                    |"));
}

TEST(AssetView, ShowsTheDecisionOfTheLastTest) {
  RemainingLife life;
  life.asset_id = "A";
  life.header = header_of_test("2031-04-12");
  life.forecasts = {forecast_of(18.0)};
  life.decision = {option_of("now", "2031-04-12", 0.0, 12.0), option_of("wait for failure", "2033-01-20", 1.0, 74.0)};
  AssetView view;
  view.take(Message(life));
  EXPECT_THAT(view.screen(), HasSubstr("wait for failure  2033-01-20  over 99.9 %  |####################|"));
  EXPECT_THAT(view.screen(), HasSubstr("before summer, 2031-06-01: 25 %  |#####               |"));
}

TEST(AssetView, ShowsTheForecastOfTheTestsSinceAReplacement) {
  RemainingLife life;
  life.asset_id = "A";
  life.header = header_of_test("2031-04-12");
  life.forecasts = {forecast_of(18.0)};
  life.tests_since_replacement = 30;
  life.replacement_known = true;
  life.replaced_ns = parse_utc("1999-01-01").value().nanoseconds;
  AssetView view;
  view.take(Message(life));
  EXPECT_THAT(view.screen(), HasSubstr("== A, replaced on 1999-01-01, last test 2031-04-12"));
  EXPECT_THAT(view.screen(), HasSubstr("16.0 .. 21.0"));

  life.header.pst_id.clear();
  life.replaced_ns = life.header.event_time_ns = parse_utc("2031-05-01").value().nanoseconds;
  life.tests_since_replacement = 0;
  life.forecasts.front().state = ForecastState::insufficient_history;
  life.forecasts.front().explanation = "the history starts anew";
  view.take(Message(life));
  EXPECT_THAT(view.screen(), HasSubstr("== A, replaced on 2031-05-01, no test since"));
  EXPECT_THAT(view.screen(), HasSubstr("the history starts anew"));
}

RemainingLife life_of(const std::string& day) {
  RemainingLife life;
  life.asset_id = "A";
  life.header = header_of_test(day);
  life.threshold = 0.6;
  life.forecasts = {forecast_of(18.0)};
  return life;
}

LeakageEstimate used_estimate(const std::string& day, double condition) {
  LeakageEstimate estimate;
  estimate.asset_id = "A";
  estimate.header = header_of_test(day);
  estimate.estimated = estimate.condition_known = estimate.used_for_forecast = true;
  estimate.condition = condition;
  return estimate;
}

// A replacement that is reported late: tests have come since, but a late subscriber has heard none of them.
TEST(AssetView, DoesNotSayNoTestSinceBesideALastTest) {
  RemainingLife life = life_of("2018-02-13");
  life.replacement_known = true;
  life.replaced_ns = parse_utc("2018-01-20").value().nanoseconds;
  life.tests_since_replacement = 1;
  AssetView view;
  view.take(Message(life));
  EXPECT_THAT(view.screen(), HasSubstr("== A, replaced on 2018-01-20, last test 2018-02-13\n"));
  view.take(Message(used_estimate("2018-02-13", 0.9)));
  EXPECT_THAT(view.screen(), HasSubstr("last test 2018-02-13, 1 test shown\n"));
}

/// Who asks for the status hears the last test alone, and the forecast is of them all.
TEST(AssetView, SaysWhichTestsItCounts) {
  RemainingLife life = life_of("2018-02-13");
  life.forecasts.at(0).tests_used = 8;
  AssetView view;
  view.take(Message(life));
  view.take(Message(used_estimate("2018-02-13", 0.9)));
  EXPECT_THAT(view.screen(), HasSubstr("last test 2018-02-13, 1 test shown, 8 usable in the forecast\n"));
  life.forecasts[0].tests_used = 1;
  view.take(Message(life));
  EXPECT_THAT(view.screen(), HasSubstr("last test 2018-02-13, 1 test shown\n"));
}

TEST(AssetView, DrawsTheFailureLimitOnlyWhereItIsKnown) {
  RemainingLife life = life_of("2031-03-12");
  AssetView with;
  AssetView without;
  for (const auto& [day, condition] : {std::pair("2031-01-12", 0.92), {"2031-02-12", 0.91}, {"2031-03-12", 0.90}}) {
    with.take(Message(used_estimate(day, condition)));
    without.take(Message(used_estimate(day, condition)));
  }
  with.take(Message(life));
  EXPECT_THAT(with.screen(), ::testing::AllOf(HasSubstr("fails\n"), HasSubstr("  55.0 |")));
  life.threshold = 0.0;
  without.take(Message(life));
  EXPECT_THAT(without.screen(), ::testing::AllOf(Not(HasSubstr("fails")), HasSubstr("  85.0 |"), Not(HasSubstr("- -")),
                                                 Not(HasSubstr("   0.0 |"))));
}

TEST(AssetView, KeepsADatedWordBeforeAnUndatedOne) {
  RemainingLife undated = life_of("2031-04-12");
  undated.header.event_time_known = false;
  undated.header.event_time_ns = 0;
  AssetView view;
  view.take(Message(undated));
  EXPECT_THAT(view.screen(), Not(HasSubstr(", last test")));
  view.take(Message(life_of("2031-04-12")));
  view.take(Message(undated));
  EXPECT_THAT(view.screen(), HasSubstr("last test 2031-04-12"));
}

TEST(AssetView, SaysWhichModelVersionIsAcceptedAndFromWhen) {
  AssetView view;
  ModelDiscrepancy found;
  found.asset_id = "A";
  found.header = header_of_test("2031-04-12");
  found.header.message_id = "model_discrepancy/A-2031-04-12";
  found.version = 2;
  found.analysed = true;
  found.verdict = DiscrepancyVerdict::mismatch;
  found.physics.resize(1);
  view.take(Message(found));
  EXPECT_THAT(view.screen(), HasSubstr("(version 2: sealwatch accept --asset-id A --discrepancy " +
                                       found.header.message_id + " --by NAME)"));

  ModelAcceptance acceptance;
  acceptance.asset_id = "A";
  acceptance.header = header_of_test("2031-04-13");
  acceptance.discrepancy_id = found.header.message_id;
  acceptance.discrepancy_time_ns = found.header.event_time_ns;
  acceptance.version = 2;
  acceptance.accepted_by = "Ada";
  view.take(Message(acceptance));
  EXPECT_THAT(view.screen(), HasSubstr("version 2: model_discrepancy/A-2031-04-12 accepted by Ada: takes effect from "
                                       "the next test on\n"));
  EXPECT_THAT(view.screen(), Not(HasSubstr("sealwatch accept")));

  StateReport state;
  state.asset_id = "A";
  state.header = header_of_test("2031-05-12");
  state.accepted_discrepancy = found.header.message_id;
  view.take(Message(state));
  EXPECT_THAT(view.screen(), HasSubstr("accepted by Ada: tests are simulated with it\n"));

  acceptance.header = header_of_test("2031-05-13");
  acceptance.revoked = true;
  view.take(Message(acceptance));
  EXPECT_THAT(view.screen(), HasSubstr("revoked by Ada: from the next test on its file's model again\n"));
  EXPECT_THAT(view.screen(), HasSubstr("sealwatch accept")) << "what was revoked can be accepted again";
}

TEST(OneLine, NamesTheSensorAndCountsInTheSingular) {
  HealthReport health;
  health.asset_id = "A";
  health.header = header_of_test("2031-04-12");
  health.admissible_for_prognosis = true;
  ProposedFault fault;
  fault.kind = FaultKind::sensor;
  fault.element = "sensor:pressure_a";
  fault.likelihood = 0.51;
  health.ambiguity_group = {fault};
  EXPECT_THAT(one_line(Message(health)), HasSubstr("most likely sensor pressure A (51 %)"));
  ServiceStatus status;
  status.pending_inputs = 1;
  status.written = {{.topic = "advisory", .writer_id = "w", .sequence = 1}};
  EXPECT_THAT(one_line(status), HasSubstr("1 message written, 1 input waiting"));
  EXPECT_THAT(scored_line(scored(1, 1, 1)), HasSubstr("of the last 1 forecast (3 months ahead), "));
}

TEST(AssetView, HintsAtAcknowledgingOnlyWhereServicesRun) {
  Advisory advisory;
  advisory.asset_id = "A";
  advisory.advisory_id = "recommendation/A-1";
  advisory.action = AdvisoryAction::book_vessel;
  AssetView view;
  view.take(Message(advisory));
  EXPECT_THAT(view.screen(), HasSubstr("(sealwatch acknowledge A recommendation/A-1 --by NAME)"));
  EXPECT_THAT(view.screen(false), Not(HasSubstr("acknowledge")));
  EXPECT_EQ(view.call(), "INFORMATION, book vessel");
}

TEST(AssetView, KeepsTheActiveAdvisoryAndNamesWhatWasLeftOut) {
  AssetView view;
  Advisory active;
  active.asset_id = "A";
  active.recommendation = "Book a vessel.";
  view.take(Message(active));
  Advisory superseded = active;
  superseded.state = AdvisoryState::superseded;
  superseded.recommendation = "Do nothing.";
  view.take(Message(superseded));
  LeakageEstimate left_out;
  left_out.asset_id = "A";
  left_out.header = header_of_test("2031-04-12");
  left_out.reasons = {"cut after 7 s", "no hold"};
  view.take(Message(left_out));
  EXPECT_THAT(view.screen(), HasSubstr("Book a vessel."));
  EXPECT_THAT(view.screen(), Not(HasSubstr("Do nothing.")));
  EXPECT_THAT(view.screen(), HasSubstr("cut after 7 s (and 1 more"));
}

TEST(AssetView, WhatIsConcludedAnewAfterARetractionTakesThePlaceOfALaterTest) {
  AssetView view;
  HealthReport retracted;
  retracted.asset_id = "A";
  retracted.header.pst_id = "A-2";
  retracted.header.event_time_known = true;
  retracted.header.event_time_ns = 20;
  retracted.health_grade_known = true;
  retracted.health_grade = 0.1;
  HealthReport anew = retracted;
  anew.header.pst_id.clear();
  anew.header.source_ids = {"retraction/A/test/A-2/2031-01-01T00:00:00Z"};
  anew.header.event_time_ns = 10;
  anew.health_grade = 0.9;
  view.take(Message(retracted));
  view.take(Message(anew));
  EXPECT_THAT(view.screen(), HasSubstr("grade 0.90"));
}

TEST(AssetView, TheLeakageOfARetractedTestIsNotShown) {
  AssetView view;
  for (const auto& [date, resistance] : {std::pair{"2031-04-12", 1.867e13}, std::pair{"2031-05-12", 1.852e13}}) {
    LeakageEstimate estimate;
    estimate.asset_id = "A";
    estimate.header = header_of_test(date);
    estimate.header.message_id = date;
    estimate.estimated = true;
    estimate.resistance_Pa_s_m3 = resistance;
    estimate.resistance_std_Pa_s_m3 = 1e11;
    view.take(Message(estimate));
  }
  EXPECT_THAT(view.screen(), HasSubstr("(18.52 ± 0.10)·10¹²"));
  RemainingLife anew;
  anew.asset_id = "A";
  anew.header = header_of_test("2031-04-12");
  anew.header.pst_id.clear();
  anew.header.source_ids = {"retraction/A/test/A-2031-05-12/2031-05-20T00:00:00Z"};
  view.take(Message(anew));
  EXPECT_THAT(view.screen(), HasSubstr("(18.67 ± 0.10)·10¹²"));
}

TEST(OneLine, ToldOfNoTestAStateReportIsOverdueOrJudgedAnew) {
  StateReport report;
  report.asset_id = "A";
  report.verdict_reasons = {"tests retracted by J. Silva"};
  EXPECT_THAT(one_line(Message(report)), HasSubstr("judged anew (tests retracted by J. Silva)"));
  report.pst_overdue = true;
  EXPECT_THAT(one_line(Message(report)), HasSubstr("test overdue"));
}

}  // namespace
}  // namespace sealwatch::cli

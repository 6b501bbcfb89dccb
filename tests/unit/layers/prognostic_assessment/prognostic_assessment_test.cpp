// The prognosis layer by its contract: joins, restarts, replacements, unordered tests, requests.
#include "services/prognostic_assessment/prognostic_assessment.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <random>

#include "tests/unit/layers/prognostic_assessment/fixtures.hpp"
#include "tests/unit/layers/prognostic_assessment/layer_contract.hpp"

namespace sealwatch::prognostic_assessment {
namespace {

using namespace sealwatch::test;
using testing::Each;
using testing::HasSubstr;

/// The straight line over 36 months: exact on the straight lives of these tests.
const Forecast& straight_line(const RemainingLife& life) {
  const Forecast& line = life.forecasts.at(1);
  EXPECT_EQ(line.method, "ols");
  EXPECT_EQ(line.window_months, 36);
  return line;
}

class PrognosticAssessmentTest : public testing::Test {
 protected:
  std::unique_ptr<Layer> make() const { return PrognosticAssessment::make(configuration_, estimator_).value(); }
  std::vector<Message> run(const std::vector<Message>& inputs, std::optional<std::size_t> death_after = {}) const {
    return run_layer([this] { return make(); }, inputs, death_after);
  }

  Configuration configuration_ = configuration();
  ScriptedEstimator estimator_;
};

TEST_F(PrognosticAssessmentTest, NamesEveryEstimateThatAForecastCounts) {
  const RemainingLife life = of_kind<RemainingLife>(run(inputs_of(straight_life(1, 72)))).back();
  EXPECT_EQ(life.tests_since_replacement, 72);
  EXPECT_EQ(std::ranges::count_if(life.header.source_ids,
                                  [](const std::string& id) { return id.starts_with("leakage_estimate/"); }),
            72);
}

TEST_F(PrognosticAssessmentTest, EveryTestGivesEstimateRemainingLifeAndRequest) {
  const auto outputs = run(inputs_of(straight_life(1, 60)));
  ASSERT_EQ(outputs.size(), 180u);
  const RemainingLife life = of_kind<RemainingLife>(outputs).back();
  EXPECT_EQ(life.header.message_id, "remaining_life/" + TestCase{.month = 60}.pst_id());
  EXPECT_EQ(life.header.producer, "prognostic_assessment 0.1.0");
  EXPECT_TRUE(life.header.replay && life.header.event_time_known);
  EXPECT_EQ(life.header.source_ids.front(), "leakage_estimate/" + life.header.pst_id);
  EXPECT_NEAR(life.condition, 0.76, 1e-9);
  EXPECT_EQ(life.tests_since_replacement, 60);
  const Forecast& in_charge = life.forecasts.front();
  EXPECT_EQ(in_charge.method, "state_space");
  EXPECT_EQ(in_charge.window_months, forecast::kWholeLife_months);
  ASSERT_EQ(in_charge.state, ForecastState::ok) << in_charge.explanation;
  EXPECT_NEAR(in_charge.rul_months, 40.0, 1.0);  // expects a seal that ages like others; this one does not
  EXPECT_NEAR(straight_line(life).rul_months, 40.0, 1e-6);
  ASSERT_EQ(in_charge.failure_probability.size(), 2u);
  EXPECT_EQ(in_charge.failure_probability[0].label, "summer 2016");
  EXPECT_LT(in_charge.failure_probability[0].probability, 0.01);
  const LeakageEstimate estimate = of_kind<LeakageEstimate>(outputs).back();
  EXPECT_THAT(estimate.header.source_ids,
              testing::ElementsAre("health_report/" + estimate.header.pst_id, "test_window/" + estimate.header.pst_id));
}

TEST_F(PrognosticAssessmentTest, OrderOfTheJoinDoesNotMatter) {
  const auto life = straight_life(1, 30);
  std::vector<Message> reports_first;
  for (const TestCase& test : life) reports_first.emplace_back(test.health());
  for (const TestCase& test : life) reports_first.emplace_back(test.window());
  EXPECT_EQ(run(reports_first), run(inputs_of(life)));
}

TEST_F(PrognosticAssessmentTest, AForgedHalfHoldsUpNothingAndAnyNumberTakesNoMoreMemory) {
  const auto life = straight_life(1, 30);
  const auto layer = make();
  expect_flat_under_forged_halves(*layer, {life[0].health(), life[0].window()});
  std::vector<Message> outputs;
  for (const Message& input : inputs_of(life))
    std::ranges::move(layer->receive(input).outputs, std::back_inserter(outputs));
  EXPECT_EQ(outputs, run(inputs_of(life)));
  EXPECT_EQ(layer->held(), 2U * 16U) << "those that were overtaken wait for nothing";
}

TEST_F(PrognosticAssessmentTest, DeathAnywhereChangesNothing) {
  auto life = straight_life(1, 40);
  life[10].admissible = false;
  life[20].condition = 0.97;  // stands alone
  life[30].fit_admissible = false;
  auto inputs = inputs_of(life);
  inputs.insert(inputs.begin() + 25, replacement(11.5));
  std::swap(inputs[50], inputs[53]);  // one test's report before its window, across another test
  const auto undisturbed = run(inputs);
  for (std::size_t death = 0; death < inputs.size(); ++death) ASSERT_EQ(run(inputs, death), undisturbed) << death;
}

TEST_F(PrognosticAssessmentTest, RepeatedDeliveryChangesNothing) {
  const auto life = straight_life(1, 30);
  auto inputs = inputs_of(life);
  const auto once = run(inputs);
  for (const Message& again : inputs_of({life[3], life[29]})) inputs.push_back(again);
  EXPECT_EQ(run(inputs), once);
}

TEST_F(PrognosticAssessmentTest, AfterReplacementTheHistoryStartsAnew) {
  auto inputs = inputs_of(straight_life(1, 40));
  inputs.emplace_back(replacement(40.5));
  for (TestCase test : straight_life(41, 70)) {
    test.condition = 1.0 - 0.005 * (test.month - 40.5);
    for (const Message& message : inputs_of({test})) inputs.push_back(message);
  }
  const auto lives = of_kind<RemainingLife>(run(inputs));
  ASSERT_EQ(lives.size(), 71u);
  const RemainingLife& reset = lives[40];
  EXPECT_EQ(reset.tests_since_replacement, 0);
  EXPECT_FALSE(lives[39].replacement_known);
  EXPECT_TRUE(reset.replacement_known && lives.back().replacement_known);
  EXPECT_EQ(lives.back().replaced_ns, reset.header.event_time_ns);
  EXPECT_THAT(reset.forecasts.front().explanation, HasSubstr("seal replaced on 2013-05"));
  EXPECT_EQ(lives[41].tests_since_replacement, 1);
  EXPECT_EQ(lives[41].forecasts.front().state, ForecastState::insufficient_history);
  const Forecast window_24 = lives.back().forecasts[2];
  ASSERT_EQ(window_24.method, "ols");
  ASSERT_EQ(window_24.window_months, 24);
  EXPECT_NEAR(window_24.rul_months, 40.5 + 80.0 - 70.0, 1e-6);
}

TEST_F(PrognosticAssessmentTest, AReplacementThatALostJournalForgotIsLearntFromTheFirstTestAfterIt) {
  auto inputs = inputs_of(straight_life(1, 40));
  for (Message& later : inputs_of(straight_life(41, 44))) {
    auto* health = std::get_if<HealthReport>(&later);
    if (health && health->header.pst_id == straight_life(41, 41).front().pst_id())
      health->header.source_ids.push_back(replacement(40.5).header.message_id);
    inputs.push_back(later);
  }
  const RemainingLife life = of_kind<RemainingLife>(run(inputs)).back();
  EXPECT_EQ(life.tests_since_replacement, 4);
  EXPECT_EQ(life.replaced_ns, replacement(40.5).header.event_time_ns);
}

TEST_F(PrognosticAssessmentTest, AReplacementFromBeforeAllTestsLeavesTheForecast) {
  auto inputs = inputs_of(straight_life(1, 40));
  inputs.emplace_back(replacement(-120.0));  // a wrong year
  const auto before = of_kind<RemainingLife>(run(inputs_of(straight_life(1, 40))));
  const RemainingLife after = of_kind<RemainingLife>(run(inputs)).back();
  EXPECT_TRUE(after.header.pst_id.empty());
  EXPECT_EQ(after.tests_since_replacement, before.back().tests_since_replacement);
  ASSERT_EQ(after.forecasts.front().state, ForecastState::ok);
  EXPECT_EQ(straight_line(after).rul_months, straight_line(before.back()).rul_months);
  EXPECT_THAT(after.forecasts.front().explanation, HasSubstr("reported after this test"));
  EXPECT_EQ(after.header.event_time_ns, before.back().header.event_time_ns) << "its months count from the last test";
  EXPECT_LT(after.replaced_ns, before.front().header.event_time_ns);
}

TEST_F(PrognosticAssessmentTest, OfTwoReplacementsTheLatestCountsWhicheverWasReportedLast) {
  const std::int64_t second = replacement(40.5).header.event_time_ns;
  for (const double first : {30.5, -5.0, 40.2}) {
    auto inputs = inputs_of(straight_life(1, 40));
    inputs.emplace_back(replacement(40.5));
    inputs.emplace_back(replacement(first));
    const auto lives = of_kind<RemainingLife>(run(inputs));
    ASSERT_EQ(lives.size(), 42u);
    EXPECT_EQ(lives.back().replaced_ns, second) << first;
    EXPECT_EQ(lives.back().header.event_time_ns, second);
    EXPECT_EQ(lives.back().tests_since_replacement, 0);
    EXPECT_THAT(lives.back().forecasts.front().explanation,
                HasSubstr("replaced on 2013-05-17: the history starts anew; seal replaced on 20"));
    for (const Message& message : inputs_of(straight_life(41, 43))) inputs.push_back(message);
    EXPECT_EQ(of_kind<RemainingLife>(run(inputs)).back().tests_since_replacement, 3) << first;
    EXPECT_EQ(of_kind<RemainingLife>(run(inputs)).back().replaced_ns, second) << first;
  }
}

TEST_F(PrognosticAssessmentTest, AnEarlierReplacementAfterTestsOfTheLaterOneChangesNothing) {
  auto inputs = inputs_of(straight_life(1, 40));
  inputs.emplace_back(replacement(20.5));
  const RemainingLife before = of_kind<RemainingLife>(run(inputs)).back();
  inputs.emplace_back(replacement(10.5));
  const RemainingLife after = of_kind<RemainingLife>(run(inputs)).back();
  EXPECT_EQ(after.replaced_ns, replacement(20.5).header.event_time_ns);
  EXPECT_EQ(after.tests_since_replacement, before.tests_since_replacement);
  EXPECT_EQ(straight_line(after).rul_months, straight_line(before).rul_months);
}

TEST_F(PrognosticAssessmentTest, DeathBetweenTwoReplacementsChangesNothing) {
  auto inputs = inputs_of(straight_life(1, 8));
  inputs.emplace_back(replacement(8.5));
  inputs.emplace_back(replacement(4.5));
  for (const Message& message : inputs_of({{.month = 6.2}, {.month = 3.2}, {.month = 9.0}})) inputs.push_back(message);
  const auto undisturbed = run(inputs);
  for (std::size_t death = 0; death < inputs.size(); ++death) ASSERT_EQ(run(inputs, death), undisturbed) << death;
}

TEST_F(PrognosticAssessmentTest, AReplacementRenewsTheRequest) {
  auto inputs = inputs_of(straight_life(1, 3));
  inputs.emplace_back(replacement(3.5));
  auto requests = of_kind<PstRequest>(run(inputs));
  ASSERT_EQ(requests.size(), 4u);
  EXPECT_EQ(requests.back().due_time_ns, add_months(add_months(kInstalled, 3.5), 1.0).nanoseconds);
  EXPECT_EQ(requests.back().reason, "seal replaced on 2010-04-17: first regular test 1 month after it");
  EXPECT_EQ(requests.back().header.message_id, "pst_request/" + replacement(3.5).header.message_id);
  EXPECT_EQ(requests.back().header.event_time_ns, replacement(3.5).header.event_time_ns);
  // A test of the old seal that comes after it asks for nothing, nor does an earlier replacement.
  for (const Message& message : inputs_of({{.month = 3.2}})) inputs.push_back(message);
  inputs.emplace_back(replacement(2.5));
  EXPECT_EQ(of_kind<PstRequest>(run(inputs)), requests);
  // The next test of the new one does, and says what it rests on.
  for (const Message& message : inputs_of({{.month = 4.5}})) inputs.push_back(message);
  requests = of_kind<PstRequest>(run(inputs));
  ASSERT_EQ(requests.size(), 5u);
  EXPECT_EQ(requests.back().reason, "regular test, 1 month after that of 2010-05-17");
}

TEST_F(PrognosticAssessmentTest, AReplacementThatIsReportedAfterLaterTestsLeavesTheirRequest) {
  auto inputs = inputs_of(straight_life(1, 3));
  const auto before = of_kind<PstRequest>(run(inputs));
  inputs.emplace_back(replacement(1.5));
  EXPECT_EQ(of_kind<PstRequest>(run(inputs)), before);
}

TEST_F(PrognosticAssessmentTest, ReplacementPartsTheHistoryByEventTimeNotByArrival) {
  auto inputs = inputs_of(straight_life(1, 40));
  inputs.emplace_back(replacement(30.5));  // reported ten months late
  for (const Message& message : inputs_of(straight_life(41, 41))) inputs.push_back(message);
  EXPECT_EQ(of_kind<RemainingLife>(run(inputs)).back().tests_since_replacement, 11);
}

TEST_F(PrognosticAssessmentTest, TestsInAnyOrderEndInTheSameForecast) {
  auto life = straight_life(1, 59);
  std::mt19937_64 random(4);
  std::shuffle(life.begin(), life.end(), random);
  life.push_back({.month = 60, .condition = 0.76});
  const RemainingLife shuffled = of_kind<RemainingLife>(run(inputs_of(life))).back();
  const RemainingLife in_order = of_kind<RemainingLife>(run(inputs_of(straight_life(1, 60)))).back();
  EXPECT_EQ(shuffled, in_order);
}

TEST_F(PrognosticAssessmentTest, LateOldTestIsJudgedAtItsOwnTimeAndAsksForNothing) {
  auto life = straight_life(1, 60);
  const TestCase late = life[40];
  life.erase(life.begin() + 40);
  life.push_back(late);
  const auto outputs = run(inputs_of(life));
  EXPECT_NEAR(straight_line(of_kind<RemainingLife>(outputs).back()).rul_months, 100.0 - 41.0, 1e-6);
  EXPECT_EQ(of_kind<PstRequest>(outputs).size(), 59u);
}

TEST_F(PrognosticAssessmentTest, LeftOutTestsChangeNoForecast) {
  auto life = straight_life(1, 60);
  auto spoiled = life;
  spoiled[45] = {.month = 46, .condition = 0.61, .admissible = false};
  spoiled[50] = {.month = 51, .condition = 0.99, .fit_admissible = false};
  const RemainingLife without = of_kind<RemainingLife>(run(inputs_of(spoiled))).back();
  EXPECT_NEAR(straight_line(without).rul_months, 40.0, 1e-6);
  EXPECT_EQ(straight_line(without).tests_used, 34);
  EXPECT_EQ(without.forecasts.front().tests_used, 58);
}

TEST_F(PrognosticAssessmentTest, LoneMonthWaitsForConfirmation) {
  auto life = straight_life(1, 61);
  life[59].condition = life[60].condition = 0.65;
  const auto outputs = run(inputs_of(life));
  const auto estimates = of_kind<LeakageEstimate>(outputs);
  EXPECT_FALSE(estimates[59].used_for_forecast);
  EXPECT_THAT(estimates[59].reasons, testing::ElementsAre(HasSubstr("stands alone")));
  EXPECT_THAT(of_kind<PstRequest>(outputs)[59].reason, HasSubstr("repeat"));
  EXPECT_TRUE(estimates[60].used_for_forecast);
  const auto lives = of_kind<RemainingLife>(outputs);
  EXPECT_NEAR(straight_line(lives[59]).rul_months, 40.0, 1e-6);
  EXPECT_THAT(lives[59].forecasts.front().explanation, HasSubstr("2015-01-01 (65.0 %)"));
  EXPECT_LT(straight_line(lives[60]).rul_months, 35.0);  // both count now
  EXPECT_LT(lives[60].forecasts.front().rul_months, 35.0);
}

TEST_F(PrognosticAssessmentTest, RequestsTheNextTestOrARepetition) {
  auto life = straight_life(1, 2);
  life[1].admissible = false;
  const auto requests = of_kind<PstRequest>(run(inputs_of(life)));
  ASSERT_EQ(requests.size(), 2u);
  EXPECT_EQ(requests[0].due_time_ns, add_months(add_months(kInstalled, 1), 1.0).nanoseconds);
  EXPECT_THAT(requests[0].reason, HasSubstr("regular"));
  EXPECT_EQ(requests[1].due_time_ns, add_months(kInstalled, 2).nanoseconds);
  EXPECT_THAT(requests[1].reason, HasSubstr("cut after 7.4 s"));
}

TEST_F(PrognosticAssessmentTest, SaysWhyThereIsNoForecast) {
  const auto no_time = of_kind<RemainingLife>(run(inputs_of({{.time_known = false}}))).back();
  EXPECT_THAT(no_time.forecasts.front().explanation, HasSubstr("no start time"));
  const auto no_seal = of_kind<RemainingLife>(run(inputs_of({{.asset_id = "BENCH-1"}}))).back();
  EXPECT_EQ(no_seal.forecasts.front().state, ForecastState::insufficient_history);
  EXPECT_THAT(no_seal.forecasts.front().explanation, HasSubstr("no seal resistances"));
  const auto outputs = run(inputs_of({{.asset_id = "NOBODY"}}));
  EXPECT_THAT(of_kind<LeakageEstimate>(outputs).back().reasons, Each(HasSubstr("'NOBODY' is not configured")));
  EXPECT_EQ(outputs.size(), 2u);
}

TEST_F(PrognosticAssessmentTest, AssetsDoNotMix) {
  Configuration two = configuration_;
  two.assets[1].condition = ConditionSetting{
      .parameter = "R_CL", .at_100 = 2.6e13, .at_60 = 4.64e12, .unit = "Pa s/m3", .part = "piston seal"};
  auto inputs = inputs_of(straight_life(1, 40));
  for (TestCase test : straight_life(1, 40)) {
    test.asset_id = "BENCH-1";
    test.condition = 1.0 - 0.008 * test.month;
    for (const Message& message : inputs_of({test})) inputs.push_back(message);
  }
  const auto outputs = run_layer([&] { return PrognosticAssessment::make(two, estimator_).value(); }, inputs);
  EXPECT_NEAR(straight_line(of_kind<RemainingLife>(outputs)[39]).rul_months, 60.0, 1e-6);
  EXPECT_NEAR(straight_line(of_kind<RemainingLife>(outputs)[79]).rul_months, 10.0, 1e-6);
}

TEST_F(PrognosticAssessmentTest, OptionsAreChecked) {
  EXPECT_FALSE(PrognosticAssessment::make(configuration_, estimator_, {.largest_condition_std = 0.0}));
  EXPECT_FALSE(PrognosticAssessment::make(configuration_, estimator_, {.forecasters = {{"oracle", 36}}}));
}

TEST_F(PrognosticAssessmentTest, ForecastsThatComeTrueRaiseConfidenceAndADriftTakesIt) {
  auto life = straight_life(1, 60);
  const RemainingLife steady = of_kind<RemainingLife>(run(inputs_of(life))).back();
  EXPECT_EQ(steady.scored_forecasts, 8);
  EXPECT_GE(steady.coverage_95, 0.75);
  EXPECT_GT(steady.mean_crps, 0.0);
  EXPECT_GT(steady.confidence, 0.9);
  for (std::size_t k = 50; k < life.size(); ++k) life[k].condition -= 0.012 * static_cast<double>(k - 49);
  const RemainingLife drifting = of_kind<RemainingLife>(run(inputs_of(life))).back();
  EXPECT_LT(drifting.coverage_80, steady.coverage_80);
  EXPECT_GT(drifting.mean_crps, steady.mean_crps);
  EXPECT_LT(drifting.confidence, 0.5);
}

TEST_F(PrognosticAssessmentTest, NothingScoredIsNoConfidence) {
  const RemainingLife first = of_kind<RemainingLife>(run(inputs_of(straight_life(1, 1)))).back();
  EXPECT_EQ(first.scored_forecasts, 0);
  EXPECT_EQ(first.confidence, 0.0);
  EXPECT_TRUE(first.decision.empty());
}

TEST_F(PrognosticAssessmentTest, DecisionTableHasEveryCampaignAndCostsWhereTheSiteGivesThem) {
  const auto inputs = inputs_of(straight_life(1, 60));
  const auto without = of_kind<RemainingLife>(run(inputs)).back().decision;
  ASSERT_EQ(without.size(), 4U);
  EXPECT_EQ(without[0].label, "now");
  EXPECT_EQ(without[1].label, "summer 2016");
  EXPECT_EQ(without[3].label, "wait for failure");
  EXPECT_EQ(without[3].failure_probability, 1.0);
  EXPECT_FALSE(without[1].cost_known || without[1].cheapest);
  configuration_.decisions["north"].costs =
      SiteCosts{.planned = 10.0, .after_failure = 50.0, .failed_month = 2.0, .unused_month = 0.2, .currency = "MNOK"};
  const auto with = of_kind<RemainingLife>(run(inputs)).back().decision;
  ASSERT_EQ(with.size(), 4U);
  EXPECT_EQ(with[1].failure_probability, without[1].failure_probability);
  EXPECT_EQ(with[1].currency, "MNOK");
  EXPECT_NEAR(with[3].expected_cost, 50.0 + 2.0 * 12.0, 1e-9);
  EXPECT_EQ(std::count_if(with.begin(), with.end(), [](const auto& one) { return one.cheapest; }), 1);
  EXPECT_TRUE(with[1].cheapest) << "the last campaign that is safe: now wastes 40 months of life";
}

/// Remembers whether it was called off.
class Obedient final : public Estimator {
 public:
  std::vector<FitReport> estimate(const AssetConfig&, const TimeSeries&, std::span<const Phase>,
                                  const std::stop_token& cancel) const override {
    called_off = cancel.stop_requested();
    return {};
  }
  mutable bool called_off = false;
};

TEST_F(PrognosticAssessmentTest, TheEstimateOfATestCanBeCalledOff) {
  const Obedient estimator;
  const auto layer = PrognosticAssessment::make(configuration_, estimator).value();
  const TestCase test;
  std::stop_source stop;
  (void)layer->receive_until(test.health(), stop.get_token());
  stop.request_stop();
  (void)layer->receive_until(test.window(), stop.get_token());
  EXPECT_TRUE(estimator.called_off);
}

/// With the accepted friction the estimator finds half the resistance.
class EstimatorOfPhysics final : public Estimator {
 public:
  std::vector<FitReport> estimate(const AssetConfig& asset, const TimeSeries&, std::span<const Phase>,
                                  const std::stop_token&) const override {
    return {fit("eha", asset.physics.empty() ? 2.0e13 : 1.0e13, 1e10)};
  }
};

TEST_F(PrognosticAssessmentTest, TheAcceptedModelIsFittedUntilTheActuatorIsReplaced) {
  const EstimatorOfPhysics estimator;
  ModelAcceptance acceptance;
  acceptance.asset_id = kAsset;
  acceptance.header.message_id = "model_acceptance/1";
  acceptance.discrepancy_id = "D1";
  acceptance.discrepancy_time_ns = add_months(kInstalled, 2.0).nanoseconds;
  acceptance.explained.model = "eha";
  acceptance.explained.physics = {{.id = "coulomb", .element = "load", .parameters = {}}};
  std::vector<Message> inputs = inputs_of(straight_life(1, 3));
  ModelDiscrepancy published;
  published.asset_id = kAsset;
  published.header.message_id = "D1";
  published.header.event_time_ns = acceptance.discrepancy_time_ns;
  published.version = acceptance.version;
  published.analysed = true;
  published.verdict = DiscrepancyVerdict::mismatch;
  published.physics = {{}};
  published.explained = acceptance.explained;
  ModelAcceptance forged = acceptance;
  forged.header.message_id = "model_acceptance/forged";
  forged.explained.physics.clear();
  inputs.emplace_back(published);
  inputs.emplace_back(acceptance);
  inputs.emplace_back(forged);
  for (const Message& message : inputs_of(straight_life(4, 5))) inputs.push_back(message);
  inputs.emplace_back(replacement(5.5));
  for (const Message& message : inputs_of(straight_life(6, 6))) inputs.push_back(message);
  const auto make_layer = [&]() -> std::unique_ptr<Layer> {
    return PrognosticAssessment::make(configuration_, estimator).value();
  };
  const auto undisturbed = run_layer(make_layer, inputs);
  const auto estimates = of_kind<LeakageEstimate>(undisturbed);
  ASSERT_EQ(estimates.size(), 6U);
  EXPECT_EQ(estimates[2].resistance_Pa_s_m3, 2.0e13);
  EXPECT_EQ(estimates[2].accepted_discrepancy, "");
  EXPECT_EQ(estimates[3].resistance_Pa_s_m3, 1.0e13);
  EXPECT_EQ(estimates[4].accepted_discrepancy, "D1");
  EXPECT_EQ(estimates[5].resistance_Pa_s_m3, 2.0e13);
  for (std::size_t death = 0; death < inputs.size(); ++death)
    ASSERT_EQ(run_layer(make_layer, inputs, death), undisturbed) << death;
}

}  // namespace
}  // namespace sealwatch::prognostic_assessment

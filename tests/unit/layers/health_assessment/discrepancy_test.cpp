// Residuals that persist lead to the analysis of the stored tests: when, of which, and the same whatever is killed.
#include <gmock/gmock.h>

#include "services/health_assessment/health_assessment.hpp"
#include "tests/unit/layers/contract.hpp"
#include "tests/unit/layers/state_detection/synthetic_test.hpp"

namespace sealwatch {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

/// Says which recordings it was given.
class TellingExplainer final : public Explainer {
 public:
  ModelDiscrepancy explain(const AssetConfig& asset, std::span<const Recording> fit, std::span<const Recording> holdout,
                           const std::stop_token& /*cancel*/) const override {
    ModelDiscrepancy found;
    found.analysed = true;
    found.summary = asset.asset_id + " fit";
    for (const Recording& recording : fit) found.summary += " " + recording.recording_id;
    found.summary += " aside";
    for (const Recording& recording : holdout) found.summary += " " + recording.recording_id;
    found.next_test = fit.front().samples.has("flow") ? "with flow" : "without flow";
    return found;
  }
};

enum class Residual { small, large, unjudged, accepted_small };

struct TestMessages {
  TestFeatures features;
  TestWindow window;
  StateReport report;
};

TestMessages test(int number, Residual residual, bool after_replacement = false) {
  synthetic::Circumstances circumstances;
  circumstances.number = number;
  if (number == 1) circumstances.failed_channel = "flow";
  const synthetic::Test made = synthetic::make({}, circumstances);
  TestMessages messages{.features = made.features, .window = made.window, .report = {}};
  StateReport& report = messages.report;
  report.asset_id = "A1";
  report.header = made.features.header;
  report.header.message_id = "state_report/" + report.header.pst_id;
  report.header.source_ids = {made.window.header.message_id};
  if (after_replacement) report.header.source_ids.push_back("maintenance_event/A1/x");
  report.verdict = residual == Residual::unjudged ? PstVerdict::aborted : PstVerdict::passed;
  if (residual == Residual::unjudged) return messages;
  RegionJudgement judgement;
  judgement.quantity = "residual.pressure_a";
  judgement.reference = Reference::own_baseline;
  judgement.value = 7.0;
  judgement.unit = "1";
  judgement.raw_region = residual == Residual::small ? AlertRegion::advisory : AlertRegion::warning;
  report.judgements.push_back(judgement);
  if (residual == Residual::accepted_small) {
    judgement.reference = Reference::accepted_model;
    judgement.raw_region = AlertRegion::normal;
    report.judgements.push_back(judgement);
  }
  return messages;
}

std::unique_ptr<Layer> layer() {
  const std::vector<AssetConfig> assets = {synthetic::asset("A1")};
  return std::make_unique<HealthAssessment>(assets, HealthAssessmentOptions{}, std::make_shared<TellingExplainer>());
}

/// In the order in which they come from the services: the window first, the report last.
std::vector<Message> messages_of(const std::vector<TestMessages>& tests) {
  std::vector<Message> messages;
  for (const TestMessages& one : tests) {
    messages.emplace_back(one.window);
    messages.emplace_back(one.features);
    messages.emplace_back(one.report);
  }
  return messages;
}

std::vector<TestMessages> row(int first, int last, Residual residual) {
  std::vector<TestMessages> tests;
  for (int number = first; number <= last; ++number) tests.push_back(test(number, residual));
  return tests;
}

std::vector<ModelDiscrepancy> found_in(const std::vector<Message>& messages) {
  test::StoredRun run(layer);
  for (const Message& message : messages) run.receive(message);
  std::vector<ModelDiscrepancy> found;
  for (const Message& output : run.outputs())
    if (const auto* one = std::get_if<ModelDiscrepancy>(&output)) found.push_back(*one);
  return found;
}

TEST(Discrepancy, ThirdSixthAndTwelfthDeviatingTestInARowAreAnalysed) {
  const auto found = found_in(messages_of(row(0, 13, Residual::large)));
  ASSERT_EQ(found.size(), 3U);
  EXPECT_EQ(found[0].header.message_id, "model_discrepancy/A1-2");
  EXPECT_EQ(found[0].summary, "A1 fit A1-0 A1-1 aside A1-2");
  EXPECT_THAT(found[0].fit_tests, ElementsAre("A1-0", "A1-1"));
  EXPECT_THAT(found[0].holdout_tests, ElementsAre("A1-2"));
  EXPECT_THAT(found[0].reasons,
              ElementsAre(HasSubstr("difference from the simulation in pressure A is 7, in region warning against ")));
  EXPECT_EQ(found[0].header.event_time_ns, synthetic::month(2).nanoseconds);
  EXPECT_EQ(found[1].summary, "A1 fit A1-0 A1-1 A1-2 A1-3 aside A1-4 A1-5");
  EXPECT_EQ(found[2].summary, "A1 fit A1-6 A1-7 A1-8 A1-9 aside A1-10 A1-11");
  EXPECT_EQ(found[0].version, 1);
  EXPECT_EQ(found[2].version, 3);
}

TEST(Discrepancy, ChannelsThatFailedTakeNoPart) {
  const auto found = found_in(messages_of(row(1, 3, Residual::large)));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].next_test, "without flow");
}

TEST(Discrepancy, AGoodTestEndsTheRowAnUnjudgedOneDoesNot) {
  auto tests = row(0, 1, Residual::large);
  tests.push_back(test(2, Residual::small));
  for (const TestMessages& more : row(3, 4, Residual::large)) tests.push_back(more);
  EXPECT_TRUE(found_in(messages_of(tests)).empty());
  tests.push_back(test(5, Residual::unjudged));
  tests.push_back(test(6, Residual::large));
  const auto found = found_in(messages_of(tests));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].summary, "A1 fit A1-3 A1-4 aside A1-6");
}

TEST(Discrepancy, WhereTheAcceptedModelIsJudgedItAloneCounts) {
  EXPECT_TRUE(found_in(messages_of(row(0, 5, Residual::accepted_small))).empty());
}

TEST(Discrepancy, AForgedHalfStopsNoAnalysisAndAnyNumberTakesNoMoreMemory) {
  const auto assessment = layer();
  const TestMessages first = test(0, Residual::large);
  test::expect_flat_under_forged_halves(*assessment, {first.features, first.window, first.report});
  const auto forged_report = [&](int number) { return test::forged(first.report, number); };
  std::vector<Message> attacked;
  int number = 0;
  for (const Message& message : messages_of(row(0, 13, Residual::large))) {
    attacked.push_back(forged_report(number));  // a whole test, as it seems, that deviates, but for its window
    attacked.push_back(test::forged(first.features, number++));
    attacked.push_back(message);
  }
  const auto found = found_in(attacked), undisturbed = found_in(messages_of(row(0, 13, Residual::large)));
  ASSERT_EQ(found.size(), undisturbed.size());
  for (std::size_t k = 0; k < found.size(); ++k) EXPECT_EQ(found[k].summary, undisturbed[k].summary);
}

TEST(Discrepancy, AReplacementEndsTheRowAndVersionsCountAnew) {
  auto tests = row(0, 4, Residual::large);
  tests.push_back(test(5, Residual::large, true));
  for (const TestMessages& more : row(6, 7, Residual::large)) tests.push_back(more);
  const auto found = found_in(messages_of(tests));
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[1].summary, "A1 fit A1-5 A1-6 aside A1-7");
  EXPECT_EQ(found[1].version, 1);
}

/// All that can happen, with windows before and after their reports.
std::vector<Message> eventful_life() {
  auto tests = row(0, 7, Residual::large);
  tests.push_back(test(8, Residual::small));
  tests.push_back(test(9, Residual::unjudged));
  for (const TestMessages& more : row(10, 13, Residual::large)) tests.push_back(more);
  tests.push_back(test(14, Residual::large, true));
  for (const TestMessages& more : row(15, 17, Residual::large)) tests.push_back(more);
  std::vector<Message> messages = messages_of(tests);
  std::rotate(messages.begin() + 3, messages.begin() + 4, messages.begin() + 9);  // window of test 1 after report of 2
  std::swap(messages[24], messages[26]);                                          // window of test 8 after its report
  return messages;
}

TEST(Discrepancy, KilledAnywhereItEndsTheSame) { test::expect_restartable(layer, eventful_life()); }

/// The runner's way: what was left for later is lost with the process, and the inputs come again.
TEST(Discrepancy, AnAnalysisThatWasCutOffIsMadeAgain) {
  std::vector<Message> life = eventful_life();
  test::StoredRun undisturbed(layer);
  for (const Message& message : life) undisturbed.receive(message);
  for (std::size_t begun = 0; begun < life.size(); begun += 2) {
    std::unique_ptr<Layer> first = layer();
    std::vector<Message> open, outputs;
    const auto keep = [&](const Conclusion& conclusion) {
      for (const Message& output : conclusion.outputs) outputs.push_back(output);
      for (const std::string& id : conclusion.consumed)
        std::erase_if(open, [&id](const Message& input) { return header_of(input).message_id == id; });
    };
    bool cut = false;  // the thread stands still from here on
    std::size_t next = 0;
    for (; next < life.size() && !(cut && next > begun + 4); ++next) {
      open.push_back(life[next]);
      Conclusion conclusion = first->receive(life[next]);
      cut = cut || (next >= begun && conclusion.later);
      if (cut) conclusion.later = {};
      keep(completed(std::move(conclusion)));
    }
    std::unique_ptr<Layer> second = layer();
    for (const Message& output : std::vector<Message>(outputs)) second->restore(output);
    for (const Message& input : std::vector<Message>(open)) keep(completed(second->receive(input)));
    for (; next < life.size(); ++next) {
      open.push_back(life[next]);
      keep(completed(second->receive(life[next])));
    }
    std::set<std::string> expected, reached;
    for (const Message& output : undisturbed.outputs())
      if (const auto* one = std::get_if<ModelDiscrepancy>(&output))
        expected.insert(one->header.message_id + " " + std::to_string(one->version) + " " + one->summary);
    for (const Message& output : outputs)
      if (const auto* one = std::get_if<ModelDiscrepancy>(&output))
        reached.insert(one->header.message_id + " " + std::to_string(one->version) + " " + one->summary);
    EXPECT_EQ(reached, expected) << "cut off from input " << begun;
    EXPECT_EQ(open.size(), undisturbed.waiting()) << begun;
  }
}

TEST(Discrepancy, KeptTestsAreHeldAndAllOthersConsumed) {
  std::unique_ptr<Layer> watch = layer();
  std::size_t open = 0;
  for (const Message& message : messages_of(row(0, 8, Residual::large))) {
    const Conclusion conclusion = completed(watch->receive(message));
    open += 1;
    open -= conclusion.consumed.size();
  }
  EXPECT_EQ(watch->held(), 2 * kTestsOfAnalysis);
  EXPECT_EQ(open, watch->held());
  for (const Message& message : messages_of({test(9, Residual::small)})) {
    open += 1;
    open -= completed(watch->receive(message)).consumed.size();
  }
  EXPECT_EQ(watch->held(), 0U);
  EXPECT_EQ(open, 0U);
}

/// Killed between a report and its window, which comes last of all: it waits for nothing that would come within a month.
TEST(Discrepancy, AWindowThatComesAfterARestartBehindAllReportsIsNotWaitedFor) {
  const TestMessages first = test(0, Residual::small), last = test(1, Residual::small);
  std::unique_ptr<Layer> killed = layer(), started = layer();
  (void)killed->receive(Message(first.features));
  for (const Message& output : completed(killed->receive(Message(first.report))).outputs) started->restore(output);
  EXPECT_TRUE(completed(started->receive(Message(first.window))).consumed.empty());
  EXPECT_EQ(started->held(), 1U);
  std::vector<std::string> consumed;
  for (const Message& message : messages_of({last}))
    std::ranges::move(completed(started->receive(message)).consumed, std::back_inserter(consumed));
  EXPECT_THAT(consumed, Contains(first.window.header.message_id)) << "the next report shows that it is not needed";
  EXPECT_EQ(started->held(), 0U);
}

}  // namespace
}  // namespace sealwatch

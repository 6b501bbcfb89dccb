#include "services/health_assessment/health_assessment.hpp"

#include <gmock/gmock.h>

#include "services/common/message/json.hpp"
#include "services/state_detection/state_detection.hpp"
#include "tests/unit/layers/given_again.hpp"
#include "tests/unit/layers/state_detection/synthetic_test.hpp"

namespace sealwatch {
namespace {

using synthetic::Circumstances;
using synthetic::Condition;

HealthAssessment layer() {
  const std::vector<AssetConfig> assets = {synthetic::asset("A1"), synthetic::asset("A2")};
  return HealthAssessment(assets);
}

/// State reports and features of an eventful life: leakage, a cut test, a replacement, an overdue report, two assets.
std::vector<Message> eventful_life() {
  const std::vector<AssetConfig> assets = {synthetic::asset("A1"), synthetic::asset("A2")};
  StateDetection detection(assets, nullptr);
  std::vector<Message> messages;
  for (int number = 0; number < 24; ++number) {
    if (number == 15) {
      MaintenanceEvent event;
      event.asset_id = "A1";
      event.header.message_id = "maintenance_event/A1/1";
      (void)detection.receive(event);
    }
    Condition condition;
    condition.theta = 0.75 - 0.008 * (number % 15);
    Circumstances circumstances;
    circumstances.number = number < 10 ? number : number + 1;
    circumstances.asset_id = number % 6 == 3 ? "A2" : "A1";
    if (number == 7 || number == 15) circumstances.cut_after_s = 7.4;
    const synthetic::Test test = synthetic::make(condition, circumstances);
    if (number == 10)
      for (Message& overdue : detection.tick(synthetic::month(10, 25)).outputs) messages.push_back(std::move(overdue));
    (void)detection.receive(test.window);
    Conclusion conclusion = detection.receive(test.features);
    messages.emplace_back(test.features);
    for (Message& output : conclusion.outputs) messages.push_back(std::move(output));
  }
  return messages;
}

struct Journal {
  std::vector<Message> received, concluded;
  std::vector<std::string> consumed;
  void take(HealthAssessment& assessment, const Message& input) {
    received.push_back(input);
    add(test::receive(assessment, input, received));
  }
  void add(Conclusion conclusion) {
    for (Message& output : conclusion.outputs) concluded.push_back(std::move(output));
    for (std::string& id : conclusion.consumed) consumed.push_back(std::move(id));
  }
  HealthAssessment restart() {
    HealthAssessment fresh = layer();
    for (const Message& output : concluded) fresh.restore(output);
    const std::vector<std::string> done = consumed;
    for (const Message& input : received)
      if (std::find(done.begin(), done.end(), header_of(input).message_id) == done.end())
        add(test::receive(fresh, input, received));
    return fresh;
  }
  [[nodiscard]] std::vector<std::string> text() const {
    std::vector<std::string> lines;
    for (const Message& output : concluded) lines.push_back(to_json(output, JsonForm::exact));
    return lines;
  }
};

TEST(HealthAssessment, KilledAnywhereItEndsWithTheSameReports) {
  const std::vector<Message> life = eventful_life();
  Journal undisturbed;
  HealthAssessment assessment = layer();
  for (const Message& message : life) undisturbed.take(assessment, message);
  ASSERT_EQ(undisturbed.concluded.size(), 24U);
  EXPECT_EQ(undisturbed.consumed.size(), life.size());
  for (std::size_t cut = 0; cut <= life.size(); ++cut) {
    Journal journal;
    HealthAssessment before = layer();
    for (std::size_t k = 0; k < cut; ++k) journal.take(before, life[k]);
    HealthAssessment after = journal.restart();
    for (std::size_t k = cut; k < life.size(); ++k) journal.take(after, life[k]);
    ASSERT_EQ(journal.text(), undisturbed.text()) << "cut at " << cut;
  }
}

TEST(HealthAssessment, OrderOfArrivalOfTheFeaturesDoesNotMatter) {
  const std::vector<Message> life = eventful_life();
  Journal in_order, reports_first;
  HealthAssessment one = layer(), other = layer();
  std::vector<Message> features;
  for (const Message& message : life) {
    in_order.take(one, message);
    if (std::holds_alternative<TestFeatures>(message))
      features.push_back(message);
    else
      reports_first.take(other, message);
  }
  for (const Message& feature : features) reports_first.take(other, feature);
  std::vector<std::string> expected = in_order.text(), found = reports_first.text();
  std::sort(expected.begin(), expected.end());
  std::sort(found.begin(), found.end());
  EXPECT_EQ(found, expected);
}

TEST(HealthAssessment, ATestWhoseOtherHalfNeverComesHoldsUpNoLaterOne) {
  Journal undisturbed, attacked;
  HealthAssessment one = layer(), other = layer();
  int number = 0;
  for (const Message& message : eventful_life()) {
    undisturbed.take(one, message);
    attacked.take(other, test::forged(message, number++));
    attacked.take(other, message);
    ASSERT_EQ(attacked.concluded.size(), undisturbed.concluded.size()) << "after " << header_of(message).message_id;
  }
  EXPECT_TRUE(attacked.text() == undisturbed.text());
  EXPECT_GT(other.held(), 0U) << "they wait on";
  EXPECT_LE(other.held(), 4U * 16U) << "of two assets, features and reports, the last";
}

TEST(HealthAssessment, UnderAnAcceptedModelFaultsSayThatItsFindingMayBeTheCause) {
  HealthAssessment assessment = layer();
  Journal journal;
  for (Message message : eventful_life()) {
    if (auto* report = std::get_if<StateReport>(&message)) report->accepted_discrepancy = "model_discrepancy/A1-3";
    journal.take(assessment, message);
  }
  int faults = 0;
  for (const Message& message : journal.concluded)
    for (const ProposedFault& fault : std::get<HealthReport>(message).ambiguity_group)
      if (fault.evidence.front().rfind("carried over", 0) != 0) {
        ++faults;
        EXPECT_THAT(fault.evidence.back(), testing::StartsWith("what model_discrepancy/A1-3 found may be the cause"));
      }
  EXPECT_GT(faults, 0);
}

TEST(HealthAssessment, HeaderNamesTestAndSources) {
  HealthAssessment assessment = layer();
  Journal journal;
  for (const Message& message : eventful_life()) journal.take(assessment, message);
  const auto& report = std::get<HealthReport>(journal.concluded.front());
  EXPECT_EQ(report.header.message_id, "health_report/A1-0");
  EXPECT_EQ(report.header.producer, "health_assessment 0.1.0");
  EXPECT_THAT(report.header.source_ids, testing::ElementsAre("state_report/A1-0", "test_features/A1-0",
                                                             "sample_block/A1-0/0", "test_window/A1-0"));
  EXPECT_EQ(report.header.event_time_ns, synthetic::month(0).nanoseconds);
}

TEST(HealthAssessment, UnknownEventTimeHasNoTrend) {
  const std::vector<AssetConfig> assets = {synthetic::asset("A1")};
  StateDetection detection(assets, nullptr);
  HealthAssessment assessment = layer();
  for (int number = 0; number < 12; ++number) {
    Circumstances circumstances;
    circumstances.number = number;
    circumstances.event_time_known = false;
    const synthetic::Test test = synthetic::make({}, circumstances);
    (void)detection.receive(test.window);
    (void)assessment.receive(test.features);
    const Conclusion state = detection.receive(test.features);
    const Conclusion health = assessment.receive(state.outputs.front());
    EXPECT_FALSE(std::get<HealthReport>(health.outputs.front()).trend_known);
  }
}

TEST(HealthAssessment, OptionsAreChecked) {
  EXPECT_TRUE(HealthAssessmentOptions{}.validate());
  EXPECT_FALSE(HealthAssessmentOptions{5}.validate());
}

}  // namespace
}  // namespace sealwatch

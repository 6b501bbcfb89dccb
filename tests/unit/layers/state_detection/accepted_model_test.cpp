// An accepted model is judged beside the nominal one until it is revoked, superseded or its actuator replaced; and only
// what the services published is accepted.
#include <gmock/gmock.h>

#include "services/state_detection/state_detection.hpp"
#include "tests/unit/layers/contract.hpp"
#include "tests/unit/layers/state_detection/synthetic_test.hpp"

namespace sealwatch {
namespace {

/// The recording, off by 20 noises for the asset's file and by 1 with the accepted friction.
class TwoModels final : public Simulator {
 public:
  [[nodiscard]] Result<TimeSeries> simulate(const AssetConfig& asset, const TimeSeries& recorded,
                                            const std::stop_token& /*cancel*/) const override {
    TimeSeries simulated = recorded;
    std::erase_if(simulated.channels, [](const Series& series) { return series.name == "motor_voltage"; });
    for (Series& series : simulated.channels)
      for (double& value : series.values) value += (asset.physics.empty() ? 20.0 : 1.0) * series.noise_std;
    return simulated;
  }
};

ModelAcceptance acceptance(const std::string& discrepancy, int number, bool revoked = false) {
  ModelAcceptance message;
  message.asset_id = "A1";
  message.header.message_id = "model_acceptance/A1/" + std::to_string(number);
  message.discrepancy_id = discrepancy;
  message.revoked = revoked;
  message.discrepancy_time_ns = synthetic::month(3).nanoseconds;
  message.explained.model = "eha";
  message.explained.physics = {{.id = "coulomb", .element = "load", .parameters = {{"F_c", 900.0, 0.0, 2e3, false}}}};
  return message;
}

/// What health assessment published, from which `acceptance` follows.
ModelDiscrepancy discrepancy(const std::string& id) {
  const ModelAcceptance accepted = acceptance(id, 0);
  ModelDiscrepancy found;
  found.asset_id = "A1";
  found.header.message_id = id;
  found.header.event_time_known = true;
  found.header.event_time_ns = accepted.discrepancy_time_ns;
  found.version = accepted.version;
  found.analysed = true;
  found.verdict = DiscrepancyVerdict::mismatch;
  found.physics = {{}};
  found.explained = accepted.explained;
  return found;
}

MaintenanceEvent replacement(int month) {
  MaintenanceEvent event;
  event.asset_id = "A1";
  event.kind = "actuator_replaced";
  event.header.message_id = "maintenance_event/A1/" + std::to_string(month);
  event.header.event_time_known = true;
  event.header.event_time_ns = synthetic::month(month, -1.0).nanoseconds;
  return event;
}

std::unique_ptr<Layer> layer() {
  const std::vector<AssetConfig> assets = {synthetic::asset("A1")};
  return std::make_unique<StateDetection>(assets, std::make_shared<TwoModels>());
}

void add_tests(std::vector<Message>& messages, int first, int last) {
  for (int number = first; number <= last; ++number) {
    synthetic::Circumstances circumstances;
    circumstances.number = number;
    const synthetic::Test test = synthetic::make({}, circumstances);
    messages.emplace_back(test.window);
    messages.emplace_back(test.features);
  }
}

std::vector<StateReport> reports_of(const std::vector<Message>& messages) {
  test::StoredRun run(layer);
  for (const Message& message : messages) run.receive(message);
  std::vector<StateReport> reports;
  for (const Message& output : run.outputs()) reports.push_back(std::get<StateReport>(output));
  return reports;
}

int count(const StateReport& report, Reference reference) {
  int found = 0;
  for (const ResidualSummary& residual : report.residuals) found += residual.reference == reference;
  return found;
}

TEST(AcceptedModel, IsJudgedBesideTheNominalOneUntilRevoked) {
  std::vector<Message> messages;
  add_tests(messages, 0, 4);
  messages.emplace_back(discrepancy("D1"));
  messages.emplace_back(acceptance("D1", 1));
  add_tests(messages, 5, 9);
  messages.emplace_back(acceptance("other", 2, true));  // of one that is not in force
  add_tests(messages, 10, 10);
  messages.emplace_back(acceptance("D1", 3, true));
  add_tests(messages, 11, 11);
  const auto reports = reports_of(messages);
  ASSERT_EQ(reports.size(), 12U);
  EXPECT_EQ(count(reports[4], Reference::accepted_model), 0);
  EXPECT_EQ(reports[5].accepted_discrepancy, "D1");
  EXPECT_EQ(count(reports[5], Reference::accepted_model), count(reports[5], Reference::nominal_model));
  EXPECT_GT(count(reports[5], Reference::nominal_model), 3);
  for (const ResidualSummary& residual : reports[9].residuals)
    EXPECT_NEAR(residual.noise_normalised_rms, residual.reference == Reference::accepted_model ? 1.0 : 20.0, 1e-6);
  EXPECT_EQ(reports[10].accepted_discrepancy, "D1");
  EXPECT_EQ(reports[11].accepted_discrepancy, "");
  EXPECT_EQ(count(reports[11], Reference::accepted_model), 0);
}

TEST(AcceptedModel, EndsWithTheActuatorThatWasAnalysed) {
  std::vector<Message> messages;
  messages.emplace_back(discrepancy("D1"));
  messages.emplace_back(acceptance("D1", 1));
  add_tests(messages, 4, 4);
  messages.emplace_back(replacement(2));  // before what was analysed
  add_tests(messages, 5, 5);
  messages.emplace_back(replacement(6));
  add_tests(messages, 6, 6);
  const auto reports = reports_of(messages);
  EXPECT_EQ(reports[1].accepted_discrepancy, "D1");
  EXPECT_EQ(reports[2].accepted_discrepancy, "");
}

/// In a journal that is made again, what people said comes before the discrepancies (message/act_record.hpp).
TEST(AcceptedModel, ThatAReplacementEndedStaysSoWhereBothComeFirst) {
  for (const int month : {2, 6}) {
    std::vector<Message> messages;
    messages.emplace_back(acceptance("D1", 1));
    messages.emplace_back(replacement(month));
    messages.emplace_back(discrepancy("D1"));
    add_tests(messages, 7, 7);
    EXPECT_EQ(reports_of(messages)[0].accepted_discrepancy, month == 2 ? "D1" : "");
  }
}

TEST(AcceptedModel, KilledAnywhereItEndsTheSame) {
  std::vector<Message> messages;
  add_tests(messages, 0, 3);
  messages.emplace_back(discrepancy("D1"));
  messages.emplace_back(acceptance("D1", 1));
  add_tests(messages, 4, 6);
  ModelAcceptance forged = acceptance("D1", 3);
  forged.explained.physics[0].parameters[0].value = 9e3;
  messages.emplace_back(forged);
  messages.emplace_back(acceptance("D2", 2));
  add_tests(messages, 7, 8);
  messages.emplace_back(discrepancy("D2"));
  add_tests(messages, 9, 12);
  messages.emplace_back(replacement(13));
  add_tests(messages, 13, 14);
  test::expect_restartable(layer, messages);
}

/// A layer's answer to them, one after the other.
struct Answered {
  AcceptedModel model;
  Conclusion conclusion;
  void take(const auto& message) { model.take(message, conclusion); }
  [[nodiscard]] std::string refused() const {
    return conclusion.refused.empty() ? std::string() : conclusion.refused.back().reason;
  }
};

TEST(AcceptedModel, OnlyWhatWasPublishedComesIntoForce) {
  Answered one;
  one.take(discrepancy("D1"));
  ModelAcceptance forged = acceptance("D1", 1);
  forged.explained.physics[0].parameters[0].value = 9e3;
  one.take(forged);
  EXPECT_FALSE(one.model.in_force());
  EXPECT_EQ(one.refused(), "accepts 'D1', and its model is not the one that was published there");
  EXPECT_THAT(one.conclusion.consumed, testing::ElementsAre("model_acceptance/A1/1"));
  ModelAcceptance of_another_time = acceptance("D1", 2);
  of_another_time.discrepancy_time_ns += 1;
  one.take(of_another_time);
  EXPECT_FALSE(one.model.in_force()) << "a replacement would not end it when it should";
  one.take(acceptance("D1", 3));
  EXPECT_EQ(one.model.discrepancy_id(), "D1");
  one.take(forged);
  EXPECT_EQ(one.model.applied_to(synthetic::asset("A1")).physics.at(0).parameters.at("F_c").value, 900.0);
  ModelDiscrepancy nothing = discrepancy("D2");
  nothing.verdict = DiscrepancyVerdict::undetermined;
  one.take(nothing);
  one.take(acceptance("D2", 4));
  EXPECT_EQ(one.model.discrepancy_id(), "D1");
  EXPECT_THAT(one.refused(), testing::HasSubstr("explains nothing"));
}

TEST(AcceptedModel, ThatComesBeforeItsDiscrepancyWaitsForItAndNotForEver) {
  Answered one;
  one.take(acceptance("D1", 1));
  EXPECT_FALSE(one.model.in_force());
  EXPECT_EQ(one.model.held(), 1U);
  ASSERT_EQ(one.model.waiting().size(), 1U);
  EXPECT_THAT(one.model.waiting()[0].reason, ::testing::HasSubstr("no service has published 'D1'"));
  one.take(discrepancy("D1"));
  EXPECT_EQ(one.model.discrepancy_id(), "D1");
  EXPECT_TRUE(one.model.waiting().empty());
  ModelAcceptance invented = acceptance("invented", 2);
  invented.header.event_time_ns = synthetic::month(4).nanoseconds;
  one.take(invented);
  one.model.tick(synthetic::month(4), one.conclusion);
  one.model.tick(add_seconds(synthetic::month(4), 3600.0), one.conclusion);
  EXPECT_EQ(one.refused(), "");
  one.model.tick(add_seconds(synthetic::month(4), 3601.0), one.conclusion);
  EXPECT_EQ(one.refused(), "accepts 'invented', and no service has published it");
  EXPECT_EQ(one.model.discrepancy_id(), "D1");
}

/// It is fetched back after the loss of a journal, and health assessment analyses those tests again or is down.
TEST(AcceptedModel, ThatWasSaidLongAgoWaitsAsLongAsOneOfToday) {
  Answered one;
  ModelAcceptance said = acceptance("D1", 1);
  said.header.event_time_ns = synthetic::month(4).nanoseconds;
  one.take(said);
  one.model.tick(synthetic::month(40), one.conclusion);
  one.model.tick(add_seconds(synthetic::month(40), 3600.0), one.conclusion);
  EXPECT_EQ(one.refused(), "");
  one.take(discrepancy("D1"));
  EXPECT_EQ(one.model.discrepancy_id(), "D1");
}

TEST(AcceptedModel, RemembersNoMoreThanItsRoom) {
  Answered one;
  one.take(discrepancy("D0"));
  one.take(acceptance("D0", 0));
  for (int k = 1; k < 1000; ++k) {
    one.take(discrepancy("D" + std::to_string(k)));
    one.take(acceptance("invented-" + std::to_string(k), k));
  }
  EXPECT_EQ(one.model.held(), AcceptedModel::kMostKnown + AcceptedModel::kMostWaiting + 1);
  EXPECT_EQ(one.model.discrepancy_id(), "D0");
  one.take(acceptance("D999", 1000));
  EXPECT_EQ(one.model.discrepancy_id(), "D999");
  EXPECT_EQ(one.model.held(), AcceptedModel::kMostKnown + 1) << "what waited is over: another was accepted after it";
}

TEST(AcceptedModel, OfAnotherPlantIsNotApplied) {
  Answered one;
  const auto accept = [&one](ModelAcceptance accepted, const ExplainedModel& explained) {
    ModelDiscrepancy published = discrepancy(accepted.discrepancy_id);
    published.explained = accepted.explained = explained;
    one.take(published);
    one.take(accepted);
  };
  ExplainedModel other = acceptance("D1", 1).explained;
  other.model = "emps";
  accept(acceptance("D1", 1), other);
  EXPECT_TRUE(one.model.in_force());
  EXPECT_TRUE(one.model.applied_to(synthetic::asset("A1")).physics.empty());
  other.model = "eha";
  other.parameters = {{"R_CL", 1e13, 1e12, 3e13, true}, {"unknown", 1.0, 0.0, 2.0, false}};
  accept(acceptance("D2", 2), other);
  EXPECT_EQ(one.conclusion.consumed, std::vector<std::string>{"model_acceptance/A1/1"});
  const AssetConfig applied = one.model.applied_to(synthetic::asset("A1"));
  EXPECT_EQ(applied.parameter("R_CL"), 1e13);
  EXPECT_FALSE(applied.parameters.contains("unknown"));
  ASSERT_EQ(applied.physics.size(), 1U);
  EXPECT_EQ(applied.physics[0].parameters.at("F_c").value, 900.0);
}

}  // namespace
}  // namespace sealwatch

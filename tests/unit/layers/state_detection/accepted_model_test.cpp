// An accepted model is judged beside the nominal one until it is revoked, superseded or its actuator replaced.
#include <gmock/gmock.h>

#include "services/state_detection/state_detection.hpp"
#include "tests/unit/layers/contract.hpp"
#include "tests/unit/layers/state_detection/synthetic_test.hpp"

namespace sealwatch {
namespace {

/// The recording, off by 20 noises for the asset's file and by 1 with the accepted friction.
class TwoModels final : public Simulator {
 public:
  [[nodiscard]] Result<TimeSeries> simulate(const AssetConfig& asset, const TimeSeries& recorded) const override {
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

TEST(AcceptedModel, KilledAnywhereItEndsTheSame) {
  std::vector<Message> messages;
  add_tests(messages, 0, 3);
  messages.emplace_back(acceptance("D1", 1));
  add_tests(messages, 4, 8);
  messages.emplace_back(acceptance("D2", 2));
  add_tests(messages, 9, 12);
  messages.emplace_back(replacement(13));
  add_tests(messages, 13, 14);
  test::expect_restartable(layer, messages);
}

TEST(AcceptedModel, OfAnotherPlantIsNotApplied) {
  AcceptedModel model;
  ModelAcceptance other = acceptance("D1", 1);
  other.explained.model = "emps";
  EXPECT_TRUE(model.take(other).empty());
  EXPECT_TRUE(model.applied_to(synthetic::asset("A1")).physics.empty());
  other.explained.model = "eha";
  other.explained.parameters = {{"R_CL", 1e13, 1e12, 3e13, true}, {"unknown", 1.0, 0.0, 2.0, false}};
  EXPECT_EQ(model.take(other), std::vector<std::string>{"model_acceptance/A1/1"});
  const AssetConfig applied = model.applied_to(synthetic::asset("A1"));
  EXPECT_EQ(applied.parameter("R_CL"), 1e13);
  EXPECT_FALSE(applied.parameters.contains("unknown"));
  ASSERT_EQ(applied.physics.size(), 1U);
  EXPECT_EQ(applied.physics[0].parameters.at("F_c").value, 900.0);
}

}  // namespace
}  // namespace sealwatch

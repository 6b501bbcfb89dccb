#include "services/state_detection/residual.hpp"

#include <gtest/gtest.h>

#include "tests/unit/layers/state_detection/fake_simulator.hpp"
#include "tests/unit/layers/state_detection/synthetic_test.hpp"

namespace sealwatch {
namespace {

using synthetic::FakeSimulator;

TEST(Residual, FiguresByHand) {
  TimeSeries recorded;
  recorded.time_s = {0, 1, 2, 3};
  recorded.channels = {{"flow", "m3/s", 0.5, {1, -1, 1, -1}}};
  TimeSeries simulated = recorded;
  for (double& value : simulated.channels[0].values) value += 0.25;
  const auto summaries = summarise_residuals(AssetConfig{}, recorded, simulated, Reference::nominal_model);
  ASSERT_EQ(summaries.size(), 1U);
  EXPECT_NEAR(summaries[0].noise_normalised_rms, 0.5, 1e-12);
  EXPECT_NEAR(summaries[0].nrmse_percent, 75.0, 1e-12);
}

TEST(Residual, AgeingOfTheSealIsTakenOutOfTheOwnBaseline) {
  const AssetConfig asset = synthetic::asset();
  synthetic::Condition worn;
  worn.theta = 0.65;
  const double truth = asset.condition->value(0.65);
  const synthetic::Test test = synthetic::make(worn, {});
  const auto summaries = residuals_of(asset, test.window, truth, FakeSimulator(1.0, 50.0, truth), {});
  ASSERT_TRUE(summaries);
  ASSERT_EQ(summaries->summaries.size(), 14U);  // seven outputs, two references
  for (const ResidualSummary& summary : summaries->summaries) {
    if (summary.reference == Reference::own_baseline)
      EXPECT_NEAR(summary.noise_normalised_rms, 1.0, 1e-6) << summary.channel;
    else
      EXPECT_GT(summary.noise_normalised_rms, 50.0) << summary.channel;
  }
}

TEST(Residual, AgeingIsTakenOutWhereNoFlowTellsIt) {
  const AssetConfig asset = synthetic::asset();
  synthetic::Circumstances circumstances;
  circumstances.absent_channel = "flow";
  const synthetic::Test test = synthetic::make({}, circumstances);
  for (const double theta : {0.97, 0.8, 0.61}) {
    const FakeSimulator simulator(1.0, 50.0, asset.condition->value(theta));
    const auto summaries = residuals_of(asset, test.window, std::nullopt, simulator, {});
    ASSERT_TRUE(summaries);
    constexpr double kSearched = 2e-3;  // 16 bits of the logarithm, and what seven channels' noise shows
    ASSERT_TRUE(summaries->nearest_wear);
    EXPECT_NEAR(asset.condition->condition(*summaries->nearest_wear), theta, kSearched);
    for (const ResidualSummary& summary : summaries->summaries) {
      if (summary.reference != Reference::own_baseline) continue;
      EXPECT_NEAR(summary.noise_normalised_rms, 1.0, 0.1) << summary.channel << theta;
    }
  }
}

TEST(Residual, FailedChannelsStayOut) {
  synthetic::Circumstances circumstances;
  circumstances.failed_channel = "flow";
  const synthetic::Test test = synthetic::make({}, circumstances);
  const auto summaries = residuals_of(synthetic::asset(), test.window, std::nullopt, FakeSimulator(1, 0, 1e13), {});
  ASSERT_TRUE(summaries);
  for (const ResidualSummary& summary : summaries->summaries) EXPECT_NE(summary.channel, "flow");
}

/// Is called off during its second simulation, the first of the search for what wears.
class CalledOff final : public Simulator {
 public:
  [[nodiscard]] Result<TimeSeries> simulate(const AssetConfig& asset, const TimeSeries& recorded,
                                            const std::stop_token& cancel) const override {
    ++simulations;
    if (simulations == 2) stop.request_stop();
    if (cancel.stop_requested()) return fail("it was called off");
    return FakeSimulator(1.0, 50.0, 1e13).simulate(asset, recorded, cancel);
  }
  mutable std::stop_source stop;
  mutable int simulations = 0;
};

TEST(Residual, ASearchThatIsCalledOffEnds) {
  synthetic::Circumstances circumstances;
  circumstances.absent_channel = "flow";
  const synthetic::Test test = synthetic::make({}, circumstances);
  const CalledOff simulator;
  EXPECT_FALSE(residuals_of(synthetic::asset(), test.window, std::nullopt, simulator, simulator.stop.get_token()));
  EXPECT_EQ(simulator.simulations, 3) << "with what was found so far, which fails at once";
}

TEST(Residual, ATestThatCannotBeSimulatedIsAnError) {
  synthetic::Circumstances circumstances;
  circumstances.absent_channel = "motor_voltage";
  const synthetic::Test test = synthetic::make({}, circumstances);
  EXPECT_FALSE(residuals_of(synthetic::asset(), test.window, std::nullopt, FakeSimulator(1, 0, 1e13), {}));
}

}  // namespace
}  // namespace sealwatch

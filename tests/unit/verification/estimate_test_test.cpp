#include "services/verification/lives/estimate_test.hpp"

#include <gtest/gtest.h>

#include "services/verification/lives/circuit_truth.hpp"
#include "tests/unit/verification/actuator.hpp"

namespace sealwatch::verification {
namespace {

TEST(EstimateTest, TheLayersOfTheServicesGiveTheSame) {
  const AssetConfig asset = testing::actuator();
  const CircuitTruth truth = CircuitTruth::make(asset, 50.0).value();
  const UtcTime when = parse_utc("2031-04-12T03:00:00Z").value();
  for (const double condition : {0.98, 0.8, 0.61}) {
    const TimeSeries samples = truth.simulate(asset.condition->value(condition), 0.1, 5);
    const auto direct = estimate_condition(asset, samples, when);
    const auto layered = estimate_through_layers(asset, samples, when);
    ASSERT_TRUE(direct && layered);
    // Resampling to the grid that the samples stand on already may round the last digits.
    EXPECT_NEAR(direct->condition, layered->condition, 1e-6 * direct->condition_std);
    EXPECT_NEAR(direct->condition_std, layered->condition_std, 1e-6 * direct->condition_std);
    EXPECT_EQ(direct->time, layered->time);
  }
}

TEST(EstimateTest, ARecordingOfNothingIsNoEstimate) {
  const AssetConfig asset = testing::actuator();
  EXPECT_FALSE(estimate_condition(asset, {}, {}));
  TimeSeries samples = CircuitTruth::make(asset, 50.0)->simulate(1e13, 0.0, 1);
  std::erase_if(samples.channels, [](const Series& channel) { return channel.name == "flow"; });
  EXPECT_FALSE(estimate_condition(asset, samples, {}));
}

}  // namespace
}  // namespace sealwatch::verification

// Samples that do not count where the flow alone drives the simulation: around its reversals.
#include "services/common/estimation/unseen_samples.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "services/common/estimation/pem_problem.hpp"

namespace sealwatch {
namespace {

constexpr double kRate_Hz = 100.0;

AssetConfig of_actuator() {
  AssetConfig asset;
  asset.model = "eha";
  return asset;
}

// 10 s: in until 4 s, a hold with next to nothing from 4 to 6 s, then out.
TimeSeries turned_round(double noise_m3_s) {
  TimeSeries recorded;
  std::vector<double> flow, position, velocity, difference;
  for (int k = 0; k < 1000; ++k) {
    const double t = k / kRate_Hz, ripple = k % 2 == 0 ? noise_m3_s : -noise_m3_s;
    recorded.time_s.push_back(t);
    flow.push_back((t < 4.0 ? -4e-6 : t < 6.0 ? 0.0 : 4e-6) + ripple);
    position.push_back(0.04);
    velocity.push_back(0.0);
    difference.push_back(8e6);
  }
  recorded.channels = {{"flow", "m3/s", noise_m3_s, flow},
                       {"position", "m", 1e-5, position},
                       {"velocity", "m/s", 1e-5, velocity},
                       {"pressure_differential", "Pa", 1e4, difference}};
  return recorded;
}

TEST(UnseenSamples, LieAroundAReversalOfTheFlowWithTheHoldBetween) {
  const AssetConfig asset = of_actuator();
  const auto samples = unseen_samples(asset, turned_round(1e-8));
  ASSERT_FALSE(samples.empty());
  EXPECT_NEAR(static_cast<double>(samples.front()) / kRate_Hz, 3.0, 0.15) << "a second before it ends";
  EXPECT_NEAR(static_cast<double>(samples.back()) / kRate_Hz, 7.0, 0.15) << "a second after it begins again";
  EXPECT_EQ(samples.size(), static_cast<std::size_t>(samples.back() - samples.front() + 1)) << "no gap";
}

TEST(UnseenSamples, AreNoneWhereThePressureOfChamberBDrivesToo) {
  TimeSeries recorded = turned_round(1e-8);
  recorded.channels.push_back({"pressure_b", "Pa", 1e4, std::vector<double>(recorded.time_s.size(), 2e6)});
  EXPECT_TRUE(unseen_samples(of_actuator(), recorded).empty());
}

TEST(UnseenSamples, NoiseAloneReversesNothing) {
  TimeSeries recorded = turned_round(1e-8);
  for (double& flow : recorded.channels.front().values) flow = std::abs(flow) < 1e-6 ? flow : 4e-6;
  EXPECT_TRUE(unseen_samples(of_actuator(), recorded).empty());
}

TEST(UnseenSamples, HaveNoWeightInAFit) {
  const TimeSeries recorded = turned_round(1e-8);
  const AssetConfig asset = of_actuator();
  const auto problem = make_pem_problem(asset, {&recorded, 1});
  ASSERT_TRUE(problem) << problem.error().describe();
  const std::vector<double> weights = weights_of(problem->recordings.front(), 0);
  EXPECT_EQ(weights[500], 0.0);
  EXPECT_EQ(weights[100], 1.0);
  EXPECT_EQ(weights[900], 1.0);
}

}  // namespace
}  // namespace sealwatch

// Parameters that must change together along a curve: b = a^2 is known far better than a. Straight steps
// leave the valley; the search follows its bend.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <random>

#include "services/common/estimation/pem_costs.hpp"
#include "tests/unit/estimation/search_of_plant.hpp"

namespace sealwatch {
namespace {

constexpr double kA = 2.5, kRough = 0.1, kFine = 0.01;

constexpr const char* kPlant = R"yaml(name: valley
meaning: two outputs, one of which shows a and the other whether b is its square
inputs: {u: {unit: V}}
outputs:
  rough: {value: a*u, unit: V, noise_std: 0.1}
  fine: {value: (b - a*a)*u, unit: V, noise_std: 0.01}
parameters:
  a: {value: -3, min: -10, max: 10, unit: 1, estimate: true}
  b: {value: 9, min: -100, max: 100, unit: 1, estimate: true}
)yaml";

TimeSeries recording() {
  std::mt19937 random(3);
  std::normal_distribution<double> noise;
  TimeSeries samples{.time_s = {}, .channels = {{"u", "V", 0.0, {}}, {"rough", "V", 0.0, {}}, {"fine", "V", 0.0, {}}}};
  for (int row = 0; row < 200; ++row) {
    samples.time_s.push_back(0.1 * row);
    samples.channels[0].values.push_back(1.0);
    samples.channels[1].values.push_back(kA + kRough * noise(random));
    samples.channels[2].values.push_back(kFine * noise(random));
  }
  return samples;
}

TEST(CurvedValley, IsFollowedAlongItsBend) {
  const SearchOfPlant valley = search_of_plant("valley", kPlant, recording());
  EXPECT_TRUE(valley.optimum.converged) << valley.optimum.termination;
  EXPECT_LT(valley.optimum.iterations, 25);
  EXPECT_LT(valley.optimum.cost, 0.5 * 1.3 * 400.0);  // the noise of both outputs
  EXPECT_NEAR(valley.value("a"), kA, 4.0 * kRough / std::sqrt(200.0));
}

/// A step may move what belongs to other recordings only.
TEST(CurvedValley, ARecordingOfWhichNothingMovesHasNoBend) {
  const SearchOfPlant valley = search_of_plant("valley", kPlant, recording());
  const std::atomic<bool> failed = false;
  const RecordingCost cost(valley.problem, 0, failed);
  const PemPoint& at = valley.optimum.point;
  ASSERT_TRUE(cost.update(at.shared.data(), at.own[0].data()));
  cost.set_out_from_here();
  ASSERT_TRUE(cost.update(at.shared.data(), at.own[0].data()));
  const Bend bend = cost.bend(Eigen::VectorXd::Zero(2));
  EXPECT_EQ(bend.slope, Eigen::VectorXd::Zero(2));
  EXPECT_EQ(bend.square, 0.0);
}

}  // namespace
}  // namespace sealwatch

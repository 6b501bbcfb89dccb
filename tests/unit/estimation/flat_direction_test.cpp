// A parameter whose effect saturates: what the recording demands lies beyond all of its values, and the further the
// search goes, the less holds it. It ends at the end of the range, with the other parameters at what fits there.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/unit/estimation/search_of_plant.hpp"

namespace sealwatch {
namespace {

constexpr double kGain = 1.3, kLag_s = 2.0, kLargest = 5.0;

constexpr const char* kPlant = R"yaml(name: saturating
meaning: a lag whose gain k/(1 + k) comes to 1 at most
inputs: {u: {unit: V}}
outputs: {y: {value: x, unit: V, noise_std: 0.002}}
parameters:
  k: {value: 1, min: 0.1, max: 5, unit: 1, estimate: true}
  T: {value: 1, min: 0.1, max: 100, unit: s, estimate: true}
states: {x: {der: (u*k/(1 + k) - x)/T, unit: V, start: y, size: 1}}
)yaml";

TimeSeries recording() {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0.0, 0.002);
  TimeSeries samples{.time_s = {}, .channels = {{"u", "V", 0.0, {}}, {"y", "V", 0.0, {}}}};
  double y = 0.0;
  for (int row = 0; row < 400; ++row) {
    const double t = 0.1 * row, u = row / 100 % 2 == 0 ? 1.0 : 0.0;
    samples.time_s.push_back(t);
    samples.channels[0].values.push_back(u);
    samples.channels[1].values.push_back(y + noise(random));
    y += (kGain * u - y) * (1.0 - std::exp(-0.1 / kLag_s));
  }
  return samples;
}

TEST(FlatDirection, DoesNotTakeTheSearchBeyondAllMeasure) {
  TimeSeries samples = recording();
  samples.input_hold = true;
  const SearchOfPlant saturating = search_of_plant("saturating", kPlant, samples);
  const PemOptimum& optimum = saturating.optimum;
  EXPECT_TRUE(optimum.converged) << optimum.termination;
  EXPECT_LT(optimum.iterations, 30);
  EXPECT_NEAR(saturating.value("k"), kLargest, 1e-3);
  // Nothing lower beside it: T is where its own search from there ends.
  const auto polished = search(saturating.problem, optimum.point, saturating.options);
  ASSERT_TRUE(polished) << polished.error().describe();
  EXPECT_NEAR(optimum.cost, polished->cost, 1e-3 * polished->cost);
}

}  // namespace
}  // namespace sealwatch

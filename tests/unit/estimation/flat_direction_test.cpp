// A parameter whose effect saturates: what the recording demands lies beyond all of its values, and the further the
// search goes, the less holds it. It ends at the end of the range, with the other parameters at what fits there.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>

#include "services/common/estimation/pem_search.hpp"
#include "services/common/runtime/plant_file.hpp"
#include "tests/unit/model/recording_for_tests.hpp"

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
  const std::string file = ::testing::TempDir() + "saturating.yaml";
  std::ofstream(file) << kPlant;
  const auto plant = load_plant(file);
  ASSERT_TRUE(plant) << plant.error().front().describe();
  TimeSeries samples = recording();
  samples.input_hold = true;
  auto problem = make_pem_problem(nominal_asset("saturating"), {&samples, 1});
  ASSERT_TRUE(problem) << problem.error().describe();
  const ActuatorFitOptions options;
  problem->simulation_options = simulation_options({&samples, 1}, options);
  const auto optimum = search(*problem, start_point(*problem, 1.0), options);
  ASSERT_TRUE(optimum) << optimum.error().describe();
  EXPECT_TRUE(optimum->converged) << optimum->termination;
  EXPECT_LT(optimum->iterations, 30);
  const auto value = [&](std::string_view name) {
    const auto at = std::ranges::find(problem->shared, name, &Unknown::name) - problem->shared.begin();
    return problem->shared[static_cast<std::size_t>(at)].to_value(optimum->point.shared[static_cast<std::size_t>(at)]);
  };
  EXPECT_NEAR(value("k"), kLargest, 1e-3);
  // Nothing lower beside it: T is where its own search from there ends.
  PemPoint again = optimum->point;
  const auto polished = search(*problem, again, options);
  ASSERT_TRUE(polished);
  EXPECT_NEAR(optimum->cost, polished->cost, 1e-3 * polished->cost);
}

}  // namespace
}  // namespace sealwatch

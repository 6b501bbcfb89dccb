// The generator of truth against the nine-state bench: what the estimator makes of either must be the same.
#include <gtest/gtest.h>

#include <cmath>

#include "services/verification/lives/circuit_truth.hpp"
#include "services/verification/lives/estimate_test.hpp"
#include "services/virtual_bench/simulate_test.hpp"
#include "tests/unit/verification/actuator.hpp"

namespace sealwatch::verification {
namespace {

constexpr double kRate_Hz = 50.0;

TimeSeries from_bench(const AssetConfig& asset, double resistance, double load_factor, std::uint64_t seed) {
  return bench::simulate_test(asset, bench::pst_profile(asset.pst),
                              {.parameters = {{"R_CL", resistance}}, .load_factor = load_factor},
                              {.sample_rate_Hz = kRate_Hz, .seed = seed, .channels = circuit_channels()})
      .value()
      .samples;
}

double mean_square_difference(const Series& a, const Series& b) {
  double sum = 0.0;
  for (std::size_t k = 0; k < a.values.size(); ++k) sum += std::pow(a.values[k] - b.values[k], 2);
  return sum / static_cast<double>(a.values.size());
}

TEST(CircuitTruth, LooksLikeTheBench) {
  const AssetConfig asset = testing::noiseless(testing::actuator());
  const CircuitTruth truth = CircuitTruth::make(asset, kRate_Hz).value();
  for (const double load : {-0.2, 0.0, 0.2}) {
    const TimeSeries cheap = truth.simulate_without_noise(1e13, load);
    const TimeSeries full = from_bench(asset, 1e13, load, 1);
    ASSERT_EQ(cheap.time_s, full.time_s);
    // Root mean square of what the cheap generator neglects: pilot and valves' drops, the loop's start.
    const auto off = [&](const char* channel) {
      return std::sqrt(mean_square_difference(*cheap.find(channel), *full.find(channel)));
    };
    EXPECT_LT(off("position"), 1e-4);     // of 16 mm
    EXPECT_LT(off("velocity"), 1e-4);     // of 1.3 mm/s
    EXPECT_LT(off("flow"), 4e-7);         // of 8e-6 m3/s
    EXPECT_LT(off("pressure_a"), 0.6e6);  // of 11 MPa
    EXPECT_LT(off("pressure_b"), 0.6e6);  // of 1 to 3 MPa
  }
}

TEST(CircuitTruth, ConservesOilWhateverTheStep) {
  const AssetConfig asset = testing::noiseless(testing::actuator());
  for (const double step_s : {0.010, 0.002}) {
    const TimeSeries test = CircuitTruth::make(asset, kRate_Hz, step_s)->simulate_without_noise(1e13, 0.1);
    const auto& q = test.find("flow")->values;
    const auto& p_a = test.find("pressure_a")->values;
    const auto& p_b = test.find("pressure_b")->values;
    const auto& x = test.find("position")->values;
    double in = 0.0, leaked = 0.0, compressed = 0.0;
    for (std::size_t k = 1; k < q.size(); ++k) {
      in += 0.5 * (q[k] + q[k - 1]) / kRate_Hz;
      leaked += 0.5 * (p_a[k] - p_b[k] + p_a[k - 1] - p_b[k - 1]) / kRate_Hz / 1e13;
      compressed += (5e-5 + 5.89e-3 * 0.5 * (x[k] + x[k - 1])) * (p_a[k] - p_a[k - 1]) / 1.2e9;
    }
    // Trapezoids of 20 ms over a flow that moves within 20 ms: a thousandth of what was leaked.
    EXPECT_NEAR(in - 5.89e-3 * (x.back() - x.front()) - compressed, leaked, 2e-3 * leaked) << step_s;
  }
}

TEST(CircuitTruth, StepIsFineEnough) {
  const AssetConfig asset = testing::noiseless(testing::actuator());
  const TimeSeries coarse = CircuitTruth::make(asset, kRate_Hz)->simulate_without_noise(1e13, 0.1);
  const TimeSeries fine = CircuitTruth::make(asset, kRate_Hz, 0.0005)->simulate_without_noise(1e13, 0.1);
  for (const Series& channel : coarse.channels) {
    const double off = std::sqrt(mean_square_difference(channel, *fine.find(channel.name)));
    const double noise = testing::actuator().sensors.at(channel.name).noise_std;
    EXPECT_LT(off, 0.5 * noise) << channel.name;
  }
}

// Both truths, the same seeds of noise: R_CL is recovered within its standard error from either, and the difference
// between the two is small against it.
TEST(CircuitTruth, GivesTheEstimatorWhatTheBenchDoes) {
  const AssetConfig asset = testing::actuator();
  const CircuitTruth truth = CircuitTruth::make(asset, kRate_Hz).value();
  constexpr int kTests = 12;
  for (const double condition : {0.95, 0.62}) {
    const double resistance = asset.condition->value(condition);
    double chi_cheap = 0.0, chi_full = 0.0, std_ratio = 0.0, shift = 0.0;
    for (int seed = 1; seed <= kTests; ++seed) {
      const double load = -0.2 + 0.4 * (seed - 1) / (kTests - 1);
      const auto cheap = estimate_condition(asset, truth.simulate(resistance, load, seed), {});
      const auto full = estimate_condition(asset, from_bench(asset, resistance, load, seed), {});
      ASSERT_TRUE(cheap && full) << condition << ", seed " << seed;
      chi_cheap += std::pow((cheap->condition - condition) / cheap->condition_std, 2) / kTests;
      chi_full += std::pow((full->condition - condition) / full->condition_std, 2) / kTests;
      shift += (cheap->condition - full->condition) / full->condition_std / kTests;
      std_ratio += cheap->condition_std / full->condition_std / kTests;
    }
    constexpr double kChiSquareLimit = 2.7;  // mean of 12 squares, 99.9 % quantile 32.9/12
    EXPECT_LT(chi_cheap, kChiSquareLimit) << condition;
    EXPECT_LT(chi_full, kChiSquareLimit) << condition;
    EXPECT_LT(std::abs(shift), 1.0) << condition;
    EXPECT_NEAR(std_ratio, 1.0, 0.1) << condition;
  }
}

TEST(CircuitTruth, RefusesWhatItCannotSimulate) {
  AssetConfig asset = testing::actuator();
  asset.model = "emps";
  EXPECT_FALSE(CircuitTruth::make(asset, kRate_Hz));
  asset = testing::actuator();
  asset.pst.stroke_m = -0.1;  // beyond the end
  EXPECT_FALSE(CircuitTruth::make(asset, kRate_Hz));
  EXPECT_FALSE(CircuitTruth::make(testing::actuator(), 0.0));
  asset = testing::actuator();
  asset.physics.push_back({.id = "coulomb_friction", .element = "piston", .parameters = {}});
  EXPECT_FALSE(CircuitTruth::make(asset, kRate_Hz));
}

}  // namespace
}  // namespace sealwatch::verification

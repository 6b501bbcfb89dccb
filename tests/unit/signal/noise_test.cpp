// Noise and stuck sensors on signals whose answers are known.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include "sealwatch/signal/jumps.hpp"
#include "sealwatch/signal/noise_floor.hpp"
#include "sealwatch/signal/stuck.hpp"

namespace sealwatch::signal {
namespace {

std::vector<double> white_noise(std::size_t size, double standard_deviation, unsigned seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal(0.0, standard_deviation);
  std::vector<double> values(size);
  for (double& value : values) value = normal(generator);
  return values;
}

// The median absolute deviation of 4000 third differences scatters by about 2.5 %: three standard errors.
constexpr double kNoiseFloorTolerance = 0.075;

TEST(NoiseFloor, SeesTheNoiseOfUnevenSamples) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> distance(0.001, 0.019);
  for (const double noise_std : {1e-4, 0.02}) {
    std::vector<double> values = white_noise(4000, noise_std, 1), time_s(values.size(), 0.0);
    for (std::size_t k = 1; k < time_s.size(); ++k) time_s[k] = time_s[k - 1] + distance(random);
    for (std::size_t k = 0; k < values.size(); ++k) values[k] += 5.0 * std::sin(0.5 * time_s[k]);
    EXPECT_NEAR(estimate_noise_floor(values, time_s).standard_deviation, noise_std, kNoiseFloorTolerance * noise_std);
    if (noise_std < 1e-3) {
      EXPECT_GT(estimate_noise_floor(values).standard_deviation, 10.0 * noise_std)
          << "by distances that count as equal";
    }
  }
}

TEST(NoiseFloor, SeesTheNoiseUnderAMovingSignal) {
  std::vector<double> values = white_noise(4000, 0.02, 1);
  for (std::size_t k = 0; k < values.size(); ++k)
    values[k] += 5.0 * std::sin(0.01 * static_cast<double>(k)) + (k > 2000 ? 3.0 : 0.0);
  EXPECT_NEAR(estimate_noise_floor(values).standard_deviation, 0.02, kNoiseFloorTolerance * 0.02);
}

// A bath that warms and is dosed with cold water every fifth sample: most differences have a jump in them.
TEST(NoiseFloor, SeesTheNoiseBetweenJumps) {
  for (const std::size_t period : {5, 12, 40}) {
    std::vector<double> values = white_noise(4000, 0.02, 3);
    for (std::size_t k = 0; k < values.size(); ++k) values[k] += 0.65 * static_cast<double>(k % period);
    constexpr double kFewerDifferences = 0.1;
    EXPECT_NEAR(estimate_noise_floor(values).standard_deviation, 0.02, kFewerDifferences * 0.02) << period;
  }
}

TEST(Jumps, AreToldFromSlopesCornersOutliersAndNoise) {
  std::vector<double> values = white_noise(400, 0.02, 4);
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double t = static_cast<double>(k);
    values[k] += k < 100 ? 0.5 * t : k < 200 ? 100.0 - 0.5 * t : 3.0 * std::sin(0.3 * t);  // corners at 100 and 200
    if (k >= 150) values[k] += 5.0;
    if (k >= 300) values[k] -= 7.0;
  }
  values[50] += 20.0;
  EXPECT_EQ(find_jumps(values), (std::vector<std::size_t>{150, 300}));
  EXPECT_EQ(find_jumps(values, 6.0), (std::vector<std::size_t>{300}));
  EXPECT_TRUE(find_jumps(white_noise(3, 1.0, 1)).empty());
}

// Eight samples a period: third differences show 0.1 of the signal, ten times the noise.
TEST(NoiseFloor, SeesTheNoiseUnderAFastSignal) {
  std::vector<double> values = white_noise(4000, 0.01, 2);
  for (std::size_t k = 0; k < values.size(); ++k) values[k] += std::sin(0.785 * static_cast<double>(k));
  EXPECT_NEAR(estimate_noise_floor(values).standard_deviation, 0.01, 0.1 * 0.01);
}

TEST(NoiseFloor, IsAtLeastWhatQuantisationMakes) {
  std::vector<double> values;
  for (int k = 0; k < 1000; ++k) values.push_back(0.25 * std::round(2.0 * std::sin(0.002 * k)));
  const NoiseFloor floor = estimate_noise_floor(values);
  EXPECT_DOUBLE_EQ(floor.quantisation_step, 0.25);
  EXPECT_DOUBLE_EQ(floor.standard_deviation, 0.25 / std::sqrt(12.0));
}

TEST(NoiseFloor, SeesTheNoiseUnderACourseWithJumpsAndGaps) {
  std::vector<double> values = white_noise(4000, 3.0, 7);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double t = static_cast<double>(i) / 100.0;
    values[i] += 500.0 * std::sin(t) + 10.0 * t * t + (i > 1000 ? 1e4 : 0.0);
  }
  for (const std::size_t lost : {100U, 101U, 2000U}) values[lost] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NEAR(estimate_noise_floor(values).standard_deviation, 3.0, kNoiseFloorTolerance * 3.0);
}

TEST(NoiseFloor, OfASensorThatRestsOnItsStepIsItsSteps) {
  std::vector<double> values;
  for (int i = 0; i < 400; ++i) values.push_back(i < 300 ? 0.0 : 0.5 * std::round((i - 300) * 0.37));
  EXPECT_GE(estimate_noise_floor(values).standard_deviation, 0.5 / std::sqrt(12.0) - 1e-12);
  EXPECT_LT(estimate_noise_floor(values).standard_deviation, 0.5);
}

TEST(BelievedNoise, IsTheRecordingsOwnThenWhatSamplesShowThenTheSensors) {
  Series channel{.name = "flow", .unit = "m3/s", .noise_std = 0.0, .values = white_noise(4000, 2.0, 3)};
  EXPECT_NEAR(believed_noise_std(channel, 5.0), 2.0, kNoiseFloorTolerance * 2.0);
  EXPECT_DOUBLE_EQ(believed_noise_std(channel, 100.0), 10.0) << "a counter that stands still for most of the test";
  channel.noise_std = 0.5;
  EXPECT_DOUBLE_EQ(believed_noise_std(channel, 100.0), 0.5);
  channel = {.name = "flow", .unit = "m3/s", .noise_std = 0.0, .values = std::vector<double>(100, 7.0)};
  EXPECT_DOUBLE_EQ(believed_noise_std(channel, 5.0), 5.0);
  EXPECT_DOUBLE_EQ(believed_noise_std(channel, 0.0), 0.0);
}

TEST(NoiseFloor, SaysNothingWhereNothingCanBeSaid) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(estimate_noise_floor({}).standard_deviation, 0.0);
  EXPECT_EQ(estimate_noise_floor(std::vector<double>{1.0, 2.0}).standard_deviation, 0.0);
  EXPECT_EQ(estimate_noise_floor(std::vector<double>(100, 7.0)).standard_deviation, 0.0);
  EXPECT_EQ(estimate_noise_floor(std::vector<double>(100, nan)).standard_deviation, 0.0);
}

/// 100 samples a second of a channel, with one witness that moves by 1 a second from 2 s to 4 s.
std::optional<ConstantRun> stuck(const StuckRule& rule, const std::vector<double>& values, double least_move = 0.5) {
  StuckWatch watch(rule, {least_move});
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double time_s = 0.01 * static_cast<double>(k);
    watch.add(time_s, values[k], std::array{std::clamp(time_s - 2.0, 0.0, 2.0)});
  }
  return watch.stuck();
}

std::vector<double> constant_between(std::size_t begin, std::size_t end) {
  std::vector<double> values = white_noise(600, 1.0, 5);
  for (std::size_t k = begin; k < end; ++k) values[k] = 0.25;
  return values;
}

TEST(Stuck, IsWhatStaysWhileItsWitnessMoves) {
  const StuckRule rule{.least_samples = 20, .least_s = 0.5};
  const auto run = stuck(rule, constant_between(250, 350));
  ASSERT_TRUE(run);
  EXPECT_DOUBLE_EQ(run->begin_s, 2.5);
  EXPECT_DOUBLE_EQ(run->end_s, 3.49);
  EXPECT_DOUBLE_EQ(run->value, 0.25);
  EXPECT_EQ(run->samples, 100U);
  EXPECT_FALSE(stuck(rule, constant_between(0, 200))) << "nothing moved";
  EXPECT_FALSE(stuck(rule, constant_between(250, 290))) << "too short";
  EXPECT_FALSE(stuck(rule, constant_between(250, 350), std::numeric_limits<double>::infinity()));
}

TEST(Stuck, IsWhatShowsNoNoiseWhereItsNoiseShows) {
  const StuckRule rule{.least_samples = 20, .least_s = 0.5, .noise_shows = true};
  EXPECT_TRUE(stuck(rule, constant_between(0, 200)));
  std::vector<double> cut_off = constant_between(0, 200);
  std::fill_n(cut_off.begin(), 200, 0.0);
  EXPECT_FALSE(stuck(rule, cut_off)) << "a meter's low-flow cut-off";
}

TEST(Stuck, IsNotWhatRoundsOrIsAtTheEndOfItsRange) {
  const StuckRule rule{.least_samples = 60, .times_the_next = 10.0, .spare_ends = true};
  EXPECT_TRUE(stuck(rule, constant_between(250, 350)));
  std::vector<double> twice = constant_between(250, 350);
  std::fill_n(twice.begin() + 400, 50, 0.125);
  EXPECT_FALSE(stuck(rule, twice)) << "it rounds: it stays elsewhere too";
  std::vector<double> saturated = constant_between(250, 350);
  for (double& value : saturated) value = std::min(value, 0.25);
  EXPECT_FALSE(stuck(rule, saturated));
}

TEST(Stuck, RunsEndWhereSamplesAreMissing) {
  StuckWatch watch({.least_samples = 20}, {0.5});
  for (int k = 0; k < 30; ++k) {
    if (k == 15) watch.interrupt();
    watch.add(0.01 * k, 1.0, std::array{0.1 * k});
  }
  EXPECT_FALSE(watch.stuck());
  for (int k = 30; k < 40; ++k) watch.add(0.01 * k, 1.0, std::array{0.1 * k});
  EXPECT_TRUE(watch.stuck());
}

}  // namespace
}  // namespace sealwatch::signal

#include "sealwatch/signal/resampling.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace sealwatch::signal {
namespace {

constexpr double kInterval_s = 0.02;

double wave(double t) { return std::sin(2.0 * std::numbers::pi * 1.0 * t); }

std::vector<double> waves(const std::vector<double>& times) {
  std::vector<double> values;
  for (const double t : times) values.push_back(wave(t));
  return values;
}

std::vector<double> uniform(std::size_t count, double begin_s = 0.0) {
  std::vector<double> times;
  for (std::size_t i = 0; i < count; ++i) times.push_back(begin_s + kInterval_s * static_cast<double>(i));
  return times;
}

TEST(Resampling, AUniformRecordingPassesUnchanged) {
  const std::vector<double> times = uniform(200, 0.009);
  const SamplingGrid grid = find_grid(times);
  EXPECT_EQ(grid.count, 200U);
  EXPECT_EQ(grid.missing_count, 0U);
  EXPECT_NEAR(grid.interval_s, kInterval_s, 1e-12);
  EXPECT_LT(grid.jitter_std_s, 1e-12);
  EXPECT_EQ(resample(times, waves(times), grid, Interpolation::cubic), waves(times));
}

TEST(Resampling, AbsentRowsAreCountedAndFilled) {
  std::vector<double> times = uniform(200);
  times.erase(times.begin() + 50, times.begin() + 53);
  times.erase(times.begin() + 120);
  const SamplingGrid grid = find_grid(times);
  EXPECT_EQ(grid.count, 200U);
  EXPECT_EQ(grid.missing_count, 4U);
  const std::vector<double> values = resample(times, waves(times), grid, Interpolation::cubic);
  // Linear across the gap of 4 intervals: at most (pi 4 dt)^2 / 2 of a 1 Hz wave.
  for (std::size_t k = 0; k < values.size(); ++k) EXPECT_NEAR(values[k], wave(grid.time_s(k)), 0.035) << k;
}

TEST(Resampling, JitterIsTakenOut) {
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> shift(-0.3 * kInterval_s, 0.3 * kInterval_s);
  std::vector<double> times = uniform(500);
  for (std::size_t i = 1; i + 1 < times.size(); ++i) times[i] += shift(generator);
  const SamplingGrid grid = find_grid(times);
  EXPECT_EQ(grid.count, 500U);
  // An interval is the difference of two uniform shifts: 0.3 dt sqrt(2/3).
  EXPECT_NEAR(grid.jitter_std_s, 0.3 * kInterval_s * std::sqrt(2.0 / 3.0), 0.1 * kInterval_s);
  const std::vector<double> values = resample(times, waves(times), grid, Interpolation::cubic);
  // A cubic through points 20 ms apart errs by about (2 pi dt)^4 / 40 of a 1 Hz wave; linear at the very ends.
  for (std::size_t k = 2; k + 2 < values.size(); ++k) EXPECT_NEAR(values[k], wave(grid.time_s(k)), 2e-4) << k;
}

TEST(Resampling, ShiftsNotNumbersAndHolds) {
  const std::vector<double> times = uniform(100);
  const SamplingGrid grid = find_grid(times);
  const std::vector<double> shifted = resample(times, waves(times), grid, Interpolation::cubic, 0.033);
  for (std::size_t k = 2; k < 90; ++k) EXPECT_NEAR(shifted[k], wave(grid.time_s(k) + 0.033), 2e-4) << k;

  std::vector<double> holes = waves(times);
  holes[40] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NEAR(resample(times, holes, grid, Interpolation::cubic)[40], wave(0.8), 5e-3);
  EXPECT_EQ(resample(times, holes, grid, Interpolation::hold)[40], holes[39]);
  const std::vector<double> nothing(100, std::numeric_limits<double>::quiet_NaN());
  EXPECT_THAT(resample(times, nothing, grid, Interpolation::cubic), testing::Each(0.0));
}

}  // namespace
}  // namespace sealwatch::signal

// A measured input is freed of its sensor's lag, without its corners being rounded.
#include "services/common/model/measured_input.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace sealwatch {
namespace {

constexpr double kLag_s = 0.05, kStep_s = 0.01, kNoise = 0.005, kCorner_s = 10.0;
constexpr std::size_t kSamples = 2000;

double ramped(double t) { return t < kCorner_s ? 0.0 : std::min(1.0, (t - kCorner_s) / 0.06); }

struct Measured {
  std::vector<double> time_s, values;
};

// dy/dt = (u - y) / tau, by steps a hundred times finer than the samples.
Measured measured(double noise_std) {
  Measured all;
  std::mt19937 random(20261128);
  std::normal_distribution<double> normal(0.0, 1.0);
  double y = 0.0;
  for (std::size_t k = 0; k < kSamples; ++k) {
    const double t = kStep_s * static_cast<double>(k);
    all.time_s.push_back(t);
    all.values.push_back(y + noise_std * normal(random));
    for (int part = 0; part < 100; ++part) y += (ramped(t + part * kStep_s / 100.0) - y) * kStep_s / 100.0 / kLag_s;
  }
  return all;
}

double rms_between(const std::vector<double>& inputs, double from_s, double to_s) {
  double sum = 0.0, count = 0.0;
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    const double t = kStep_s * static_cast<double>(k);
    if (t < from_s || t > to_s) continue;
    sum += std::pow(inputs[k] - ramped(t), 2);
    ++count;
  }
  return std::sqrt(sum / count);
}

TEST(MeasuredInput, CornersAreNotRoundedByMoreThanTheNoise) {
  const Measured sensor = measured(kNoise);
  const std::vector<double> inputs = undo_sensor(sensor.time_s, sensor.values, kLag_s);
  SmoothedInput rounded = smoothed_input(sensor.time_s, sensor.values, 0.04);
  for (std::size_t k = 0; k < kSamples; ++k) rounded.values[k] += kLag_s * rounded.slopes[k];
  EXPECT_GT(rms_between(rounded.values, 9.9, 10.2), 7.0 * kNoise) << "of one length everywhere";
  EXPECT_LT(rms_between(inputs, 9.9, 10.2), 6.0 * kNoise);
}

TEST(MeasuredInput, ElsewhereMostOfTheNoiseIsAveraged) {
  const Measured sensor = measured(kNoise);
  const std::vector<double> inputs = undo_sensor(sensor.time_s, sensor.values, kLag_s);
  EXPECT_LT(rms_between(inputs, 1.0, 9.0), 0.7 * kNoise)
      << "the slope alone, of two neighbours, has 3.5 times the noise, parabolas of up to 0.04 s 0.78 times";
}

TEST(MeasuredInput, TheEndsAreFreedOfTheLagToo) {
  Measured sensor;
  for (std::size_t k = 0; k < 20; ++k) {
    sensor.time_s.push_back(kStep_s * static_cast<double>(k));
    sensor.values.push_back(3.0 * sensor.time_s.back() - 3.0 * kLag_s);  // long after the start of a ramp
  }
  const std::vector<double> inputs = undo_sensor(sensor.time_s, sensor.values, kLag_s);
  EXPECT_NEAR(inputs.front(), 0.0, 1e-9);
  EXPECT_NEAR(inputs.back(), 3.0 * sensor.time_s.back(), 1e-9);
}

}  // namespace
}  // namespace sealwatch

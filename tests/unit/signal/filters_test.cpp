#include "sealwatch/signal/filters.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <random>

namespace sealwatch::signal {
namespace {

constexpr double kRate_Hz = 200.0;
constexpr double kCutoff_Hz = 5.0;

std::vector<double> sine(double frequency_Hz, std::size_t count) {
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i)
    values[i] = std::sin(2.0 * std::numbers::pi * frequency_Hz * static_cast<double>(i) / kRate_Hz);
  return values;
}

/// Amplitude and phase of the part at that frequency, over whole periods in the middle.
struct Response {
  double gain;
  double phase_rad;
};
Response response(const std::vector<double>& values, double frequency_Hz) {
  double in_phase = 0.0, quadrature = 0.0;
  const std::size_t begin = values.size() / 4, end = 3 * values.size() / 4;
  for (std::size_t i = begin; i < end; ++i) {
    const double angle = 2.0 * std::numbers::pi * frequency_Hz * static_cast<double>(i) / kRate_Hz;
    in_phase += values[i] * std::sin(angle);
    quadrature += values[i] * std::cos(angle);
  }
  const double scale = 2.0 / static_cast<double>(end - begin);
  return {scale * std::hypot(in_phase, quadrature), std::atan2(quadrature, in_phase)};
}

TEST(LowPass, GainIsButterworths) {
  for (const int order : {2, 4}) {
    const LowPass filter = LowPass::butterworth(order, kCutoff_Hz, kRate_Hz);
    for (const double f : {0.5, 2.0, 5.0, 12.0, 40.0}) {
      const double ratio =
          std::tan(std::numbers::pi * f / kRate_Hz) / std::tan(std::numbers::pi * kCutoff_Hz / kRate_Hz);
      EXPECT_NEAR(filter.gain(f), 1.0 / std::sqrt(1.0 + std::pow(ratio, 2.0 * order)), 1e-12) << f << " Hz";
    }
    EXPECT_NEAR(filter.gain(kCutoff_Hz), std::sqrt(0.5), 1e-12);
  }
}

TEST(LowPass, ForwardAndBackwardHasNoPhase) {
  const LowPass filter = LowPass::butterworth(2, kCutoff_Hz, kRate_Hz);
  for (const double f : {1.0, 5.0, 10.0}) {
    const Response twice = response(filter.apply_zero_phase(sine(f, 1600)), f);
    EXPECT_NEAR(twice.gain, filter.gain(f) * filter.gain(f), 1e-4) << f << " Hz";
    EXPECT_NEAR(twice.phase_rad, 0.0, 1e-3) << f << " Hz";
    const Response once = response(filter.apply(sine(f, 1600)), f);
    EXPECT_NEAR(once.gain, filter.gain(f), 1e-4) << f << " Hz";
    EXPECT_LT(once.phase_rad, -0.2) << "one pass must lag at " << f << " Hz";
  }
}

TEST(LowPass, RampsAndConstantsPassUnchangedToTheEnds) {
  const LowPass filter = LowPass::butterworth(2, kCutoff_Hz, kRate_Hz);
  std::vector<double> ramp;
  for (int i = 0; i < 300; ++i) ramp.push_back(5.0 + 0.1 * i);
  const std::vector<double> result = filter.apply_zero_phase(ramp);
  for (std::size_t i = 0; i < ramp.size(); ++i) EXPECT_NEAR(result[i], ramp[i], 5e-3) << i;
  EXPECT_THAT(filter.apply(std::vector<double>(50, 2.0)), testing::Each(testing::DoubleNear(2.0, 1e-12)));
}

TEST(LowPass, NoiseGainIsWhatNoiseShows) {
  const LowPass filter = LowPass::butterworth(2, kCutoff_Hz, kRate_Hz);
  std::mt19937 generator(3);
  std::normal_distribution<double> normal;
  std::vector<double> noise(40000);
  for (double& value : noise) value = normal(generator);
  double square = 0.0;
  for (const double value : filter.apply_zero_phase(noise)) square += value * value;
  // 40000 samples of 5 of 100 Hz bandwidth are some 2000 independent ones: 1.6 %; four of these.
  EXPECT_NEAR(filter.zero_phase_noise_gain() / std::sqrt(square / 40000.0), 1.0, 0.064);
}

TEST(FirstOrderLag, FollowsARampLateByItsTimeConstant) {
  std::vector<double> ramp;
  for (int i = 0; i < 400; ++i) ramp.push_back(0.005 * i);
  const std::vector<double> lagged = first_order_lag(ramp, 0.05, 0.005);
  EXPECT_NEAR(lagged.back(), ramp.back() - 0.05, 1e-9);
  // y(t) = t - tau (1 - exp(-t/tau)), exactly, at any sample
  EXPECT_NEAR(lagged[10], 0.05 - 0.05 * (1.0 - std::exp(-1.0)), 1e-12);
  EXPECT_EQ(first_order_lag(ramp, 0.0, 0.005), ramp);
}

TEST(Derivative, IsExactForParabolasAndUndoesTheIntegral) {
  std::vector<double> parabola;
  for (int i = 0; i < 20; ++i) parabola.push_back(0.01 * i * i);
  const std::vector<double> slope = derivative(parabola, 0.1);
  for (std::size_t i = 1; i + 1 < slope.size(); ++i) EXPECT_NEAR(slope[i], 0.2 * static_cast<double>(i), 1e-12);
  const std::vector<double> ramp = {0.0, 1.0, 2.0, 3.0};
  EXPECT_THAT(integral(ramp, 1.0), testing::ElementsAre(0.0, 0.5, 2.0, 4.5));
}

}  // namespace
}  // namespace sealwatch::signal

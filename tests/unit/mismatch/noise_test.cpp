// The noise that is found in recordings of a signal with rests and strokes: white, slow, rounded; and which samples do
// not count because the input jumped before them.
#include "services/common/mismatch/noise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "services/common/mismatch/input_jumps.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kSigma = 2e-3;

// A stroke out and back with rests, 100 Hz, 40 s, and noise of the given correlation from sample to sample.
TimeSeries stroke(double correlation, double rounding, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  TimeSeries samples;
  samples.channels.push_back({.name = "position", .unit = "m", .values = {}});
  double noise = kSigma * normal(random);
  for (int k = 0; k < 4000; ++k) {
    const double t = 0.01 * k;
    const double out = 1.0 / (1.0 + std::exp(-2.0 * (t - 10.0))), back = 1.0 / (1.0 + std::exp(-2.0 * (t - 25.0)));
    double value = out - back + noise;
    if (rounding > 0.0) value = rounding * std::round(value / rounding);
    samples.time_s.push_back(t);
    samples.channels[0].values.push_back(value);
    noise = correlation * noise + kSigma * std::sqrt(1.0 - correlation * correlation) * normal(random);
  }
  return samples;
}

Data four_strokes(double correlation, double rounding) {
  Data data;
  for (unsigned k = 1; k <= 4; ++k) data.samples.push_back(stroke(correlation, rounding, k));
  return data;
}

class SlowNoise : public testing::TestWithParam<double> {};

TEST_P(SlowNoise, HasItsSizeAndItsColour) {
  Data data = four_strokes(GetParam(), 0.0);
  find_noise(data, {"position"});
  EXPECT_EQ(colours_in_words(data, {"position"}).size(), 1U);
  for (std::size_t k = 0; k < data.samples.size(); ++k) {
    // 62 quiet pieces of noise at 0.7 tell its size to 4 %; recordings differ by another 3 %.
    EXPECT_NEAR(data.samples[k].channels[0].noise_std, kSigma, 0.1 * kSigma);
    // What is left of a first-order process: sqrt(1 - rho^2) of its standard deviation.
    EXPECT_NEAR(data.colour[k][0].innovation_std, std::sqrt(1.0 - GetParam() * GetParam()), 0.05);
    EXPECT_NEAR(data.colour[k][0].coefficients[0], GetParam(), 0.12);
  }
}
INSTANTIATE_TEST_SUITE_P(Correlations, SlowNoise, testing::Values(0.3, 0.5, 0.7));

// A signal of ten samples a period stays in every piece: it is not the noise's colour.
TEST(Noise, HasNoColourWhereTheSignalIsAsFast) {
  Data data = four_strokes(0.0, 0.0);
  for (TimeSeries& samples : data.samples)
    for (std::size_t k = 0; k < samples.time_s.size(); ++k)
      samples.channels[0].values[k] += std::sin(0.63 * static_cast<double>(k));
  find_noise(data, {"position"});
  EXPECT_TRUE(colours_in_words(data, {"position"}).empty());
  EXPECT_TRUE(data.colour[0][0].coefficients.empty());
}

// A mass on a spring that rings: polynomials of degree 7 leave more of it in a piece than there is noise, those of degree
// 15 do not.
TEST(Noise, HasNoColourOfAMotionThatMorePolynomialsFollow) {
  Data data = four_strokes(0.0, 0.0);
  for (TimeSeries& samples : data.samples)
    for (std::size_t k = 0; k < samples.time_s.size(); ++k)
      samples.channels[0].values[k] += 4.0 * kSigma * std::sin(0.25 * static_cast<double>(k));
  find_noise(data, {"position"});
  EXPECT_TRUE(colours_in_words(data, {"position"}).empty());
  EXPECT_EQ(data.samples[0].channels[0].noise_std, 0.0);
}

// A sensor that hardly shows noise at rest: its quiet pieces are not those in which it counts.
TEST(Noise, HasNoColourWhereRestsAreQuieterThanTheRest) {
  Data data = four_strokes(0.5, 0.0);
  for (TimeSeries& samples : data.samples)
    for (std::size_t k = 0; k < 1800; ++k) samples.channels[0].values[k] *= 1e-3;
  find_noise(data, {"position"});
  EXPECT_TRUE(colours_in_words(data, {"position"}).empty());
}

TEST(Noise, ThatIsWhiteStaysWhite) {
  Data data = four_strokes(0.0, 0.0);
  find_noise(data, {"position"});
  EXPECT_TRUE(colours_in_words(data, {"position"}).empty());
  EXPECT_EQ(data.samples[0].channels[0].noise_std, 0.0);  // left to the estimator's noise floor
}

TEST(Noise, KeepsWhatTheSidecarSays) {
  Data data = four_strokes(0.5, 0.0);
  data.samples[0].channels[0].noise_std = 1.0;
  find_noise(data, {"position"});
  EXPECT_EQ(colours_in_words(data, {"position"}).size(), 1U);
  EXPECT_EQ(data.samples[0].channels[0].noise_std, 1.0);
}

TEST(Noise, OfARoundedSlowChannelCountsTheRounding) {
  constexpr double kStep = kSigma;
  Data data = four_strokes(0.6, kStep);
  find_noise(data, {"position"});
  EXPECT_EQ(colours_in_words(data, {"position"}).size(), 1U);
  EXPECT_NEAR(data.samples[0].channels[0].noise_std, std::hypot(kSigma, kStep / std::sqrt(12.0)), 0.06 * kSigma);
}

// A colour of period six samples, as of a column that rings: white noise that is whitened by it is 3.6 times as large.
const ChannelColour kRinging{.coefficients = {0.546, -0.706, 0.038}, .innovation_std = 0.69};

TEST(Noise, ResidualsAtTheNoiseRefuteAColourThatMakesThemLarger) {
  EXPECT_TRUE(is_refuted(kRinging, 0.97, 3.6 * 3.6));
  EXPECT_FALSE(is_refuted(kRinging, 0.97, 1.0));
  EXPECT_FALSE(is_refuted(kRinging, 3.0, 3.6 * 3.6)) << "what is left is no noise";
  EXPECT_FALSE(is_refuted({}, 0.97, 3.6)) << "white already";
}

TEST(Noise, OfTwoSourcesHasTheSumOfTheirCovariances) {
  const auto [white, white_std] = sum_of_noise({}, 3.0, {16.0, 0.0, 0.0, 0.0});
  EXPECT_TRUE(white.coefficients.empty());
  EXPECT_DOUBLE_EQ(white_std, 5.0);
  const ChannelColour slow{.coefficients = {0.5, 0.2, -0.1}, .innovation_std = 0.8};
  const auto [same, same_std] = sum_of_noise(slow, 2.0, {});
  ASSERT_EQ(same.coefficients.size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(same.coefficients[k], slow.coefficients[k], 1e-12);
  EXPECT_DOUBLE_EQ(same_std, 2.0);
  // White noise of the sensor and as much that is correlated by 0.8, 0.64, 0.512: half of these correlations.
  const auto [both, both_std] = sum_of_noise({}, 1.0, {1.0, 0.8, 0.64, 0.512});
  EXPECT_DOUBLE_EQ(both_std, std::sqrt(2.0));
  ASSERT_EQ(both.coefficients.size(), 3U);
  const std::vector<double>& a = both.coefficients;
  EXPECT_NEAR(a[0] + a[1] * 0.4 + a[2] * 0.32, 0.4, 1e-12);
  EXPECT_NEAR(a[0] * 0.4 + a[1] + a[2] * 0.4, 0.32, 1e-12);
}

TEST(InputJumps, TheTwoSamplesAfterAJumpDoNotCount) {
  TimeSeries samples;
  samples.channels.push_back({.name = "motor_voltage", .unit = "V", .values = {}});
  for (int k = 0; k < 100; ++k) {
    samples.time_s.push_back(0.01 * k);
    samples.channels[0].values.push_back(0.02 * k + (k >= 40 ? 5.0 : 0.0));
  }
  EXPECT_EQ(samples_after_jumps(samples, plant_or_default({})), (std::vector<Eigen::Index>{40, 41}));
  samples.input_hold = true;  // then it is known when it came
  EXPECT_TRUE(samples_after_jumps(samples, plant_or_default({})).empty());
}

TEST(InputJumps, RampsRoundingAndNoiseAreNone) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  TimeSeries samples;
  samples.channels.push_back({.name = "motor_voltage", .unit = "V", .values = {}});
  for (int k = 0; k < 400; ++k) {
    samples.time_s.push_back(0.01 * k);
    const double ramp = k < 200 ? 0.0 : 0.05 * (k - 200);
    samples.channels[0].values.push_back(k < 100 ? std::round(0.01 * k) * 1e-3 : ramp + 1e-2 * normal(random));
  }
  EXPECT_LE(samples_after_jumps(samples, plant_or_default({})).size(),
            2U);  // the first noisy sample after a silent stretch may be one
}

}  // namespace
}  // namespace sealwatch::mismatch

#include "services/virtual_bench/sensors.hpp"

#include <gtest/gtest.h>

#include "services/virtual_bench/random.hpp"
#include "tests/unit/virtual_bench/nominal.hpp"

namespace sealwatch::bench {
namespace {

constexpr int kSamples = 20000;
constexpr double kFourSigma =
    4.0 / 141.4;  // of a mean of 20000 standard normal numbers; its spread scatters by 0.7 of it

Sensor sensor(double noise_std, double quantisation) {
  return {.channel = "position",
          .unit = "m",
          .quantity = Quantity::position,
          .setting = {.noise_std = noise_std, .quantisation = quantisation}};
}

TEST(Sensors, NoiseHasItsStandardDeviationAndNoMean) {
  const Series series = measure(sensor(2.0, 0.0), std::vector<double>(kSamples, 5.0), 3);
  EXPECT_NEAR(mean(series.values), 5.0, 2.0 * kFourSigma);
  EXPECT_NEAR(standard_deviation(series.values), 2.0, 2.0 * kFourSigma);
  EXPECT_EQ(series.noise_std, 2.0);
}

TEST(Sensors, NoiseIsNormalAndWhite) {
  NormalRandom normal(11);
  double last = 0.0, product = 0.0, beyond_2 = 0.0, fourth = 0.0;
  for (int k = 0; k < kSamples; ++k) {
    const double value = normal.next();
    product += value * last / kSamples;
    fourth += value * value * value * value / kSamples;
    beyond_2 += (std::abs(value) > 2.0 ? 1.0 : 0.0) / kSamples;
    last = value;
  }
  EXPECT_NEAR(product, 0.0, kFourSigma);
  EXPECT_NEAR(fourth, 3.0, 10.0 * kFourSigma);  // the fourth power scatters by sqrt(96) = 9.8
  EXPECT_NEAR(beyond_2, 0.0455, 0.0059);        // four sigma of a share of 0.0455
}

TEST(Sensors, QuantisationRoundsToStepsAndCountsAsNoise) {
  std::vector<double> ramp(kSamples);
  for (int k = 0; k < kSamples; ++k) ramp[k] = 1e-4 * k;
  const Series series = measure(sensor(0.0, 0.25), ramp, 3);
  std::vector<double> error(kSamples);
  for (int k = 0; k < kSamples; ++k) {
    EXPECT_EQ(series.values[k], 0.25 * std::round(series.values[k] / 0.25));
    error[k] = series.values[k] - ramp[k];
  }
  EXPECT_NEAR(standard_deviation(error), 0.25 / std::sqrt(12.0), 0.001);
  EXPECT_DOUBLE_EQ(series.noise_std, 0.25 / std::sqrt(12.0));
}

TEST(Sensors, AreOffByWhatTheAssetSays) {
  Sensor off = sensor(0.0, 0.0);
  off.setting.gain_error = 0.01;
  off.setting.offset_error = -0.5;
  EXPECT_DOUBLE_EQ(measure(off, {5.0}, 3).values[0], 1.01 * 5.0 - 0.5);
}

TEST(Sensors, ChannelsHaveTheirOwnNoise) {
  EXPECT_NE(sub_seed(1, "pressure_a"), sub_seed(1, "pressure_b"));
  EXPECT_NE(sub_seed(1, "pressure_a"), sub_seed(2, "pressure_a"));
}

TEST(Sensors, UnknownChannelsAreErrors) {
  const auto sensors = find_sensors(nominal_asset(), *find_plant("eha").value(), {"presure_a"});
  ASSERT_FALSE(sensors);
  EXPECT_NE(sensors.error().describe().find("did you mean 'pressure_a'?"), std::string::npos);
  EXPECT_FALSE(find_sensors(nominal_asset(), *find_plant("eha").value(), {"fluid_temperature"}));
}

}  // namespace
}  // namespace sealwatch::bench

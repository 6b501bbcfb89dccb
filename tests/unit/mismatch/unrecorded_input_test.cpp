// An input that swings from sample to sample is not recorded: what answers to it at once names no law.
#include "services/common/mismatch/unrecorded_input.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "sealwatch/mismatch/explain.hpp"
#include "services/common/mismatch/telling.hpp"
#include "tests/unit/mismatch/simulated_test.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kTrue_Hz = 800.0;
constexpr std::size_t kKept = 8;  // one sample of so many: 100 Hz

TimeSeries thinned(const TimeSeries& samples) {
  const auto thin = [](const std::vector<double>& values) {
    std::vector<double> kept;
    for (std::size_t k = 0; k < values.size(); k += kKept) kept.push_back(values[k]);
    return kept;
  };
  TimeSeries result{.time_s = thin(samples.time_s), .channels = {}};
  for (const Series& channel : samples.channels)
    result.channels.push_back({channel.name, channel.unit, channel.noise_std, thin(channel.values)});
  return result;
}

/// The standard test with a voltage that swings by +-`swing_V` for a second, at a frequency that differs from test to
/// test and that the recording's samples do not follow.
Recording chattering_test(const AssetConfig& truth, double load, double swing_V) {
  AssetConfig loaded = truth;
  loaded.parameters.at("phi").value *= load;
  TimeSeries fine = standard_pst(loaded, kTrue_Hz);
  std::vector<double>& voltage = std::ranges::find(fine.channels, "motor_voltage", &Series::name)->values;
  const double frequency_Hz = 38.0 + 20.0 * load;
  for (std::size_t k = 0; k < voltage.size(); ++k)
    if (fine.time_s[k] > 13.0 && fine.time_s[k] < 14.0)
      voltage[k] += swing_V * std::sin(6.2832 * frequency_Hz * fine.time_s[k]);
  Recording recording;
  recording.asset_id = truth.asset_id;
  recording.file = recording.recording_id = recording.content_hash = number(load);
  recording.samples = thinned(simulated(loaded, std::move(fine), 1.0));
  return recording;
}

std::vector<Recording> chattering_tests(double swing_V) {
  std::vector<Recording> tests;
  for (const double load : {0.8, 1.0, 1.2}) tests.push_back(chattering_test(nominal_asset("eha"), load, swing_V));
  return tests;
}

TEST(UnrecordedInput, NamesNoLaw) {
  const std::vector<Recording> tests = chattering_tests(4.0);
  const auto explanation = explain(nominal_asset("eha"), std::span(tests).first(2), std::span(tests).last(1));
  ASSERT_TRUE(explanation) << explanation.error().describe();
  EXPECT_NE(explanation->verdict, Verdict::mismatch) << explanation->summary;
  EXPECT_TRUE(explanation->effects.empty()) << explanation->summary;
  EXPECT_THAT(explanation->notes, testing::Contains(testing::HasSubstr("count less than half")));
}

/// The standard test with a voltage that a controller changes at every sample, linear between two.
Recording known_course(const AssetConfig& truth, double load) {
  return recording_of(truth, load, [](TimeSeries& samples) {
    std::mt19937 random(20261128);
    std::normal_distribution<double> restless(0.0, 0.2);
    for (double& volts : std::ranges::find(samples.channels, "motor_voltage", &Series::name)->values)
      volts += restless(random);
  });
}

UnrecordedInput of(const Recording& test) {
  const AssetConfig asset = nominal_asset("eha");
  Data data;
  data.names = {"first"};
  data.samples = {test.samples};
  return unrecorded_input(fit_model(asset, data, nullptr, 1).value(), data);
}

UnrecordedInput of_first_test(double swing_V) { return of(chattering_tests(swing_V).front()); }

TEST(UnrecordedInput, WeighsNothingWhereItIsSmooth) {
  const UnrecordedInput smooth = of_first_test(0.0);
  const auto little = smooth.weight.empty() ? 0 : (smooth.weight.front().array() < 0.5).count();
  const auto residuals = smooth.weight.empty() ? 1 : smooth.weight.front().size();
  EXPECT_LT(static_cast<double>(little), 0.05 * static_cast<double>(residuals)) << "corners of the test alone";
  EXPECT_EQ(smooth.resolution, 0.0);
}

TEST(UnrecordedInput, WeighsNothingWhereResidualsShowThatItsCourseIsKnown) {
  const UnrecordedInput known = of(known_course(nominal_asset("eha"), 1.0));
  const double least = known.weight.empty() ? 1.0 : known.weight.front().minCoeff();
  EXPECT_GT(least, 0.7) << "though it changes at every sample";
  EXPECT_EQ(known.resolution, 0.0);
}

TEST(UnrecordedInput, FeignsLawsWhereItSwings) { EXPECT_EQ(of_first_test(4.0).resolution, 0.05); }

}  // namespace
}  // namespace sealwatch::mismatch

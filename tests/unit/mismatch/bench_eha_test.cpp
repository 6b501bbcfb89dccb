// Gross mismatch: balances that name wrong datasheet values, on a simulated bench with a known error and on the real
// bench, where the free run must then follow a load that took no part. Skips, saying so, where the recordings are
// absent.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "sealwatch/mismatch/explain.hpp"
#include "services/common/mismatch/balance_search.hpp"
#include "services/common/mismatch/gross_mismatch.hpp"
#include "services/common/recording/recording_file.hpp"
#include "services/common/runtime/asset_file.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr const char* kAsset = SEALWATCH_SOURCE "/config/assets/bench_eha.yaml";

AssetConfig bench() { return *load_asset(kAsset); }

// Extend, hold, retract, wait, at 100 Hz; what is simulated starts at rest at 5 bar.
TimeSeries cycle(double out_duty, double back_duty) {
  TimeSeries samples;
  samples.channels = {{"motor_duty", "1", 0.0, {}},   {"valve_state", "1", 0.0, {}}, {"position", "m", 1e-5, {}},
                      {"pressure_a", "Pa", 1e4, {}},  {"pressure_b", "Pa", 1e4, {}}, {"shaft_speed", "rad/s", 1.0, {}},
                      {"pump_angle", "rad", 1e-2, {}}};
  for (int row = 0; row < 1400; ++row) {
    const double t = 0.01 * row;
    const bool out = t > 1.0 && t<5.0, back = t> 7.0 && t < 12.0;
    samples.time_s.push_back(t);
    samples.channels[0].values.push_back(out ? out_duty : back ? -back_duty : 0.0);
    samples.channels[1].values.push_back(out ? 1.0 : back ? -1.0 : 0.0);
    for (std::size_t c : {2U, 5U, 6U}) samples.channels[c].values.push_back(0.0);
    for (std::size_t c : {3U, 4U}) samples.channels[c].values.push_back(5e5);
  }
  return samples;
}

Data simulated(const AssetConfig& asset) {
  Data data;
  for (const auto& [out, back] : {std::pair{0.55, 0.45}, std::pair{0.7, 0.6}}) {
    TimeSeries samples = cycle(out, back);
    const auto simulation = PlantSimulation::create(asset, samples);
    EXPECT_TRUE(simulation);
    ModelValues values = (*simulation)->start();
    values.load_factor = 0.0;
    const auto outputs = (*simulation)->run(values, {});
    EXPECT_TRUE(outputs);
    for (std::size_t c = 0; c < (*simulation)->channels().size(); ++c)
      for (Series& channel : samples.channels)
        if (channel.name == (*simulation)->channels()[c])
          for (std::size_t row = 0; row < channel.values.size(); ++row)
            channel.values[row] = outputs->values(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(c));
    data.names.push_back("simulated");
    data.samples.push_back(std::move(samples));
  }
  return data;
}

TEST(Balances, NameTheDatasheetValueThatIsWrongAndTheSensorThatIsOff) {
  AssetConfig truth = bench();
  truth.parameters.at("A_B").value *= 0.8;
  truth.parameters.at("f_C").value = 3e4;
  truth.physics.push_back({"sensor_gain", "sensor:shaft_speed", {{"g", {.value = 0.1, .min = -0.5, .max = 0.5}}}});
  const auto balances = SwitchedBalances::create(simulated(truth));
  ASSERT_TRUE(balances);
  const BalanceFit fit = search_balances(bench(), **find_plant("eha_switched"), *balances, 3, 1);
  const auto found = [&](const std::string& element, const std::string& name) {
    return std::ranges::find_if(
        fit.findings, [&](const BalanceFinding& one) { return one.what.element == element && one.what.name == name; });
  };
  const auto area = found("chamber_b", "A_B"), gain = found("sensor:shaft_speed", "g");
  ASSERT_NE(area, fit.findings.end());
  ASSERT_NE(gain, fit.findings.end());
  constexpr double kShare = 0.02;
  EXPECT_NEAR(area->value, truth.parameters.at("A_B").value, kShare * truth.parameters.at("A_B").value);
  EXPECT_NEAR(gain->value, 0.1, 0.01);
  EXPECT_EQ(found("winding", "Omega_M"), fit.findings.end());
}

TEST(Balances, AreNotAskedWhereTheSimulationFollows) {
  const Data data = simulated(bench());
  EXPECT_FALSE(explain_gross_mismatch(bench(), data, {}, {}, {}));
}

std::vector<Recording> recordings(std::initializer_list<const char*> names) {
  const std::filesystem::path folder = SEALWATCH_SHARED_DATA;
  std::vector<Recording> read;
  for (const char* name : names) {
    const bool second_day = std::string(name).starts_with("day2");
    const std::string file = (folder / (second_day ? "bench_eha_day2/oct18_" + std::string(name).substr(5)
                                                   : "bench_eha/oct21_" + std::string(name)))
                                 .string() +
                             ".csv";
    if (!std::filesystem::exists(file)) return {};
    read.push_back(*read_recording(file, **find_plant("eha_switched")));
  }
  return read;
}

const ChannelComparison& channel(const PooledFit& fit, const std::string& name) {
  return *std::ranges::find(fit.channels, name, &ChannelComparison::channel);
}

// Under load 3 the motor reaches the limit of its driver, which the lighter loads never show: beside what improves the
// position, the error of the speed's sensor makes the speed worse there. It is not claimed, and the rest is.
TEST(BenchEha, ClaimsNothingThatMakesAChannelWorseUnderALoadThatTookNoPart) {
  const auto fit = recordings({"load1_stroke2", "load1_stroke4", "load2_stroke2", "load2_stroke4"});
  const auto holdout = recordings({"load3_stroke2", "load3_stroke4"});
  if (fit.empty() || holdout.empty()) GTEST_SKIP() << "the recordings bench_eha are not here";
  const auto explanation = explain(bench(), fit, holdout);
  ASSERT_TRUE(explanation);
  EXPECT_EQ(explanation->verdict, Verdict::mismatch) << explanation->summary;
  for (const ChannelComparison& one : explanation->holdout.channels)
    EXPECT_LT(one.rms_after, 1.1 * one.rms_before) << one.channel;
  EXPECT_LT(channel(explanation->holdout, "position").rms_after,
            0.6 * channel(explanation->holdout, "position").rms_before);
  EXPECT_TRUE(std::ranges::any_of(explanation->notes, [](const std::string& note) {
    return note.find("shaft speed gets worse with it") != std::string::npos;
  }));
  EXPECT_TRUE(std::ranges::none_of(
      explanation->effects, [](const FoundEffect& effect) { return effect.what.element == "sensor:shaft_speed"; }));
}

TEST(BenchEha, CarriesOverToAnotherDay) {
  const auto fit = recordings(
      {"load1_stroke2", "load1_stroke4", "load2_stroke2", "load2_stroke4", "load3_stroke2", "load3_stroke4"});
  const auto holdout = recordings({"day2_load2_stroke3", "day2_load3_stroke3"});
  if (fit.empty() || holdout.empty()) GTEST_SKIP() << "the recordings bench_eha are not here";
  const auto explanation = explain(bench(), fit, holdout);
  ASSERT_TRUE(explanation);
  EXPECT_EQ(explanation->verdict, Verdict::mismatch) << explanation->summary;
  for (const char* name : {"position", "pressure_b", "shaft_speed", "pump_angle"})
    EXPECT_LT(channel(explanation->holdout, name).rms_after, channel(explanation->holdout, name).rms_before) << name;
  EXPECT_LT(channel(explanation->holdout, "pressure_a").rms_after,  // hardly explained, and no channel may get worse
            1.1 * channel(explanation->holdout, "pressure_a").rms_before);
  EXPECT_LT(channel(explanation->holdout, "position").rms_after,  // the goal; it is 0.40 or 0.41 by the processor's exp
            0.5 * channel(explanation->holdout, "position").rms_before);
}

TEST(BenchEha, NamesNothingWhereTooLittleIsExplained) {
  const auto fit = recordings({"load1_stroke2", "load2_stroke2", "load3_stroke2"});
  if (fit.empty()) GTEST_SKIP() << "the recordings bench_eha are not here";
  const auto explanation = explain(bench(), fit, {}, {.maximum_laws = 1});
  ASSERT_TRUE(explanation);
  EXPECT_EQ(explanation->verdict, Verdict::undetermined) << explanation->summary;
  EXPECT_TRUE(explanation->effects.empty());
  EXPECT_TRUE(explanation->explained.physics.empty());
  EXPECT_FALSE(explanation->location.empty()) << "where to look is said all the same";
}

}  // namespace
}  // namespace sealwatch::mismatch

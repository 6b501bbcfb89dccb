// Public recordings against the simulation. Skipped, saying so, where the folder of recordings is absent.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "services/common/model/model_simulator.hpp"
#include "tests/unit/model/recording_for_tests.hpp"

namespace sealwatch {
namespace {

const std::filesystem::path kData = SEALWATCH_SHARED_DATA;

double rms_error(const Series& measured, const Series& predicted) {
  double sum = 0.0;
  for (std::size_t row = 0; row < measured.values.size(); ++row)
    sum += std::pow(measured.values[row] - predicted.values[row], 2);
  return std::sqrt(sum / static_cast<double>(measured.values.size()));
}

/// Share of the signal's variation that is explained: 100 (1 - |y - y_hat| / |y - mean y|).
double nrmse_percent(const Series& measured, const Series& predicted) {
  double mean = 0.0, variance = 0.0;
  for (const double value : measured.values) mean += value / static_cast<double>(measured.values.size());
  for (const double value : measured.values)
    variance += (value - mean) * (value - mean) / static_cast<double>(measured.values.size());
  return 100.0 * (1.0 - rms_error(measured, predicted) / std::sqrt(variance));
}

// The decisive check that the equations are right: recordings of an independent bench program, simulated with the
// parameters that it had, differ by the sensors' noise alone.
TEST(Recordings, OfTheConsistentBenchAreReproducedToTheNoise) {
  const auto folder = kData / "bench_cases" / "consistent";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no recordings at " << folder;
  AssetConfig asset = nominal_asset("eha");
  const auto truth = nlohmann::json::parse(std::ifstream(folder / "truth.json"));
  for (const auto& [name, value] : truth["true_free_parameters"].items()) asset.parameters.at(name).value = value;
  constexpr double kScatter = 0.05;  // four standard deviations of the rms of 3100 samples of unit noise
  for (const char* name : {"fit_0", "fit_1", "fit_2", "fit_3", "holdout_0", "holdout_1"}) {
    const TimeSeries recorded = read_recording(folder / (std::string(name) + ".csv"));
    const auto predicted = ModelSimulator().simulate(asset, recorded, {});
    ASSERT_TRUE(predicted) << predicted.error().describe();
    ASSERT_EQ(predicted->channels.size(), 7u);
    for (const Series& channel : predicted->channels)
      EXPECT_NEAR(rms_error(*recorded.find(channel.name), channel) / asset.sensors.at(channel.name).noise_std, 1.0,
                  kScatter)
          << name << " " << channel.name;
  }
}

// The real bench with its author's parameters, before anything is added: the figures of docs/records/mismatch-real.md,
// measured again.
TEST(Recordings, OfTheSwitchedBenchAreSimulatedWithTheAuthorsParameters) {
  const auto folder = kData / "bench_eha";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no recordings at " << folder;
  const AssetConfig asset = nominal_asset("eha_switched");
  for (int load = 1; load <= 3; ++load)
    for (int stroke = 1; stroke <= 4; ++stroke) {
      const std::string name = "oct21_load" + std::to_string(load) + "_stroke" + std::to_string(stroke);
      const TimeSeries recorded = read_recording(folder / (name + ".csv"));
      const auto predicted = ModelSimulator().simulate(asset, recorded, {});
      ASSERT_TRUE(predicted) << name << ": " << predicted.error().describe();
      ASSERT_EQ(predicted->channels.size(), 5u);
      std::string line = "| " + name;
      for (const Series& channel : predicted->channels) {
        const double fit = nrmse_percent(*recorded.find(channel.name), channel);
        EXPECT_TRUE(std::isfinite(fit)) << name << " " << channel.name;
        line += " | " + std::to_string(static_cast<int>(std::lround(fit)));
      }
      std::printf("%s |\n", line.c_str());
    }
}

}  // namespace
}  // namespace sealwatch

// One 31 s, 200 Hz partial stroke test: PEM of the whole actuator (six shared parameters, the load and three initial
// values) on one thread from nominal values, and the same fit by SciPy (LSODA, least_squares) on the same recording.
//
//   estimation_benchmark            both; SciPy takes half a minute; fails where the goals are missed
//   estimation_benchmark --no-scipy
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "sealwatch/estimation/actuator_fit.hpp"
#include "sealwatch/estimation/cylinder_circuit.hpp"
#include "sealwatch/model/plant_description.hpp"
#include "services/virtual_bench/simulate_test.hpp"

namespace {

using namespace sealwatch;

AssetConfig nominal_asset() {
  AssetConfig asset;
  const PlantDescription& plant = **find_plant("eha");
  for (const ParameterDescription& p : plant.parameters)
    asset.parameters[p.name] = {.value = p.value, .min = p.min, .max = p.max, .estimate = p.estimate};
  for (const ChannelDescription& c : plant.channels)
    asset.sensors[c.name] = {.noise_std = c.noise_std, .time_constant_s = c.time_constant_s};
  return asset;
}

const TimeSeries& recording() {
  static const TimeSeries samples = [] {
    const bench::TestConditions conditions{
        .parameters =
            {{"R_CL", 1.3e13}, {"f_C", 1.8e6}, {"R_PL", 4.2e13}, {"f_M", 1e-3}, {"beta", 1.05e9}, {"R_M", 0.53}},
        .load_factor = 0.1};
    return bench::simulate_test(nominal_asset(), bench::pst_profile({}), conditions, {}).value().samples;
  }();
  return samples;
}

void whole_actuator(benchmark::State& state) {
  const AssetConfig asset = nominal_asset();
  const TimeSeries& samples = recording();
  for (auto _ : state) {
    const JointFit fit = fit_actuator(asset, {&samples, 1});
    if (!fit.report.admissible) state.SkipWithError("the fit is not admissible");
    state.counters["iterations"] = fit.report.iterations;
  }
}
BENCHMARK(whole_actuator)->Unit(benchmark::kMillisecond)->Repetitions(3);

void cylinder_circuit(benchmark::State& state) {
  const AssetConfig asset = nominal_asset();
  for (auto _ : state) benchmark::DoNotOptimize(fit_cylinder_circuit(asset, recording(), {}));
}
BENCHMARK(cylinder_circuit)->Unit(benchmark::kMillisecond);

void write_csv(const std::filesystem::path& file) {
  std::ofstream stream(file);
  stream.precision(17);
  stream << "time";
  for (const Series& channel : recording().channels) stream << ',' << channel.name;
  for (std::size_t k = 0; k < recording().time_s.size(); ++k) {
    stream << '\n' << recording().time_s[k];
    for (const Series& channel : recording().channels) stream << ',' << channel.values[k];
  }
  stream << '\n';
}

constexpr double kGoal_s = 0.05;
constexpr double kGoalRatio = 600.0;

/// Seconds of each of some fits, sorted. One line says where they end, to compare with SciPy's.
std::vector<double> seconds_of_fits() {
  std::vector<double> seconds;
  for (int k = 0; k < 15; ++k) {
    const auto begin = std::chrono::steady_clock::now();
    const JointFit fit = fit_actuator(nominal_asset(), {&recording(), 1});
    seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    if (k > 0) continue;
    std::printf("sealwatch:");
    for (const EstimatedParameter& p : fit.report.parameters) std::printf(" %s %.4g,", p.name.c_str(), p.value);
    const double residuals = static_cast<double>(recording().time_s.size() * fit.report.channels.size());
    std::printf(" rms %.3f, %d iterations\n", std::sqrt(2.0 * fit.report.cost / residuals), fit.report.iterations);
  }
  std::sort(seconds.begin(), seconds.end());
  return seconds;
}

int compare_with_scipy() {
  const std::filesystem::path csv = std::filesystem::temp_directory_path() / "sealwatch_estimation_benchmark.csv";
  write_csv(csv);
  const std::vector<double> seconds = seconds_of_fits();
  const double ours = seconds[seconds.size() / 2];
  std::printf("sealwatch: %.4f s best, %.4f s median of %zu\n", seconds.front(), ours, seconds.size());
  std::fflush(stdout);
  const auto begin = std::chrono::steady_clock::now();
  const std::string command =
      std::string("OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 /usr/bin/python3 " SEALWATCH_SCIPY_SCRIPT " ") +
      csv.string();
  const int status = std::system(command.c_str());
  const double theirs = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  std::filesystem::remove(csv);
  if (status != 0) {
    std::fprintf(stderr, "the SciPy fit could not be run (python3-scipy)\n");
    return 1;
  }
  const bool met = ours <= kGoal_s && theirs / ours >= kGoalRatio;
  std::printf("SciPy: %.2f s, %.0f times our median (goals %.2f s and %.0f times: %s)\n", theirs, theirs / ours,
              kGoal_s, kGoalRatio, met ? "met" : "MISSED");
  return met ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  bool scipy = true;
  if (argc > 1 && std::strcmp(argv[argc - 1], "--no-scipy") == 0) {
    scipy = false;
    --argc;
  }
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return scipy ? compare_with_scipy() : 0;
}

// One 31 s, 200 Hz partial stroke test: PEM of the whole actuator (six shared parameters, the load and three initial
// values) on one thread from nominal values, and the same fit by SciPy (LSODA, least_squares) on the same recording.
//
//   estimation_benchmark            both; SciPy takes a minute or two
//   estimation_benchmark --no-scipy
#include <benchmark/benchmark.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>

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

double seconds_of_one_fit() {
  double best = 1e9;
  for (int k = 0; k < 5; ++k) {
    const auto begin = std::chrono::steady_clock::now();
    benchmark::DoNotOptimize(fit_actuator(nominal_asset(), {&recording(), 1}));
    best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }
  return best;
}

int compare_with_scipy() {
  const std::filesystem::path csv = std::filesystem::temp_directory_path() / "sealwatch_estimation_benchmark.csv";
  write_csv(csv);
  const double ours = seconds_of_one_fit();
  std::printf("sealwatch: %.4f s\n", ours);
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
  std::printf("SciPy: %.2f s, %.0f times as long\n", theirs, theirs / ours);
  return 0;
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

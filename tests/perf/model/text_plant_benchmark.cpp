// What a plant as text costs against the built-in one: the same recording, all sensitivities, with and without a law.
// Both are measured in turn within each round, so that what else the machine does falls on both. Goal: at most 5 times.
#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "sealwatch/model/simulation.hpp"
#include "services/common/runtime/plant_file.hpp"

namespace {

using namespace sealwatch;

AssetConfig asset_of(const PlantDescription& plant, const std::vector<PhysicsTerm>& physics) {
  AssetConfig asset;
  asset.asset_id = "BENCHMARK";
  asset.model = plant.name;
  asset.physics = physics;
  for (const ParameterDescription& row : plant.parameters)
    asset.parameters[row.name] = {row.value, row.min, row.max, row.estimate};
  return asset;
}

TimeSeries driven(const PlantDescription& plant, double amplitude, double mean, double start, double step_s) {
  constexpr int kRows = 4001;
  TimeSeries samples;
  for (const ChannelDescription& channel : plant.channels)
    samples.channels.push_back({channel.name, channel.unit, 0.0, {}});
  for (int row = 0; row < kRows; ++row) {
    samples.time_s.push_back(step_s * row);
    for (std::size_t c = 0; c < plant.channels.size(); ++c)
      samples.channels[c].values.push_back(
          plant.channels[c].input ? mean + amplitude * std::sin(2.0 * std::numbers::pi * row / 500.0) : start);
  }
  return samples;
}

/// Processor time of one simulation with all sensitivities.
double run_s(const PlantSimulation& simulation) {
  std::vector<FreeQuantity> free;
  for (const auto& parameter : simulation.plant().parameters) free.push_back(*simulation.find(parameter.name));
  for (const auto& parameter : simulation.physics_parameters()) free.push_back(*simulation.find(parameter.name));
  timespec begin{}, end{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &begin);
  const auto outputs = simulation.run(simulation.start(), free);
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &end);
  if (!outputs) std::printf("%s\n", outputs.error().describe().c_str());
  return static_cast<double>(end.tv_sec - begin.tv_sec) + 1e-9 * static_cast<double>(end.tv_nsec - begin.tv_nsec);
}

/// Ratio of the fastest runs of both.
double compare(const char* what, const std::string& native_name, const TimeSeries& samples,
               const std::vector<PhysicsTerm>& physics) {
  const auto text = load_plant(SEALWATCH_SOURCE_DIR "/config/plants/" + native_name + ".yaml");
  if (!text) return std::printf("%s\n", combine(text.error()).describe().c_str()), 1e9;
  const auto native = PlantSimulation::create(asset_of(**find_plant(native_name), physics), samples);
  const auto as_text = PlantSimulation::create(asset_of(**text, physics), samples);
  if (!native || !as_text) return 1e9;
  constexpr int kRounds = 30;
  double fastest_native = 1e9, fastest_text = 1e9;
  for (int round = 0; round < kRounds; ++round) {
    fastest_native = std::min(fastest_native, run_s(**native));
    fastest_text = std::min(fastest_text, run_s(**as_text));
  }
  std::printf("%-32s built in %7.2f ms, text %7.2f ms, %.2f times\n", what, 1e3 * fastest_native, 1e3 * fastest_text,
              fastest_text / fastest_native);
  return fastest_text / fastest_native;
}

}  // namespace

int main() {
  constexpr double kGoal = 5.0;
  PhysicsTerm friction{.id = "coulomb_friction", .element = "piston", .parameters = {}};
  friction.parameters = {{"F_c", {20.0, 0.0, 1e3, true}}, {"v_s", {1e-3, 1e-4, 1e-2, true}}};
  const TimeSeries drive = driven(**find_plant("emps"), 3.0, 0.0, 0.01, 1e-3);
  const TimeSeries tanks = driven(**find_plant("cascaded_tanks"), 1.5, 2.5, 5.0, 4.0);
  const double worst =
      std::max({compare("emps", "emps", drive, {}), compare("emps with dry friction", "emps", drive, {friction}),
                compare("cascaded_tanks", "cascaded_tanks", tanks, {})});
  std::printf("worst: %.2f times, goal: %.0f\n", worst, kGoal);
  return worst <= kGoal ? 0 : 1;
}

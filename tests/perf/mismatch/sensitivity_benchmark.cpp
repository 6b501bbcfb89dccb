// One 31 s, 200 Hz partial stroke test of `eha`: what every law without a memory would change, as `sealwatch explain`
// asks it, three ways in one run on one thread:
//   the pass          all columns in one simulation (injected at strength 0)
//   differences       one more simulation for each column, the law in force with a thousandth of its usual size, at a
//                     tolerance a thousand times tighter
//   CVODES            staggered forward sensitivities, Jacobian and right-hand sides by the same equations
// Columns are compared, so that all three are known to solve the same problem.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "sealwatch/model/plant_description.hpp"
#include "services/common/mismatch/candidates.hpp"
#include "services/common/mismatch/sensitivity_pass.hpp"
#include "services/common/model/law_columns.hpp"
#include "services/virtual_bench/simulate_test.hpp"
#include "tests/perf/mismatch/cvodes_sensitivities.hpp"

namespace {

using namespace sealwatch;
using namespace sealwatch::mismatch;

constexpr double kLittle = 1e-3;  // of a law's usual size
// Differences need a solution that is more accurate by about that factor, or they show the integrator's own error.
constexpr SimulationOptions kTight = {.relative_tolerance = 5e-9};

AssetConfig asset_without_lags() {
  AssetConfig asset;
  const PlantDescription& plant = **find_plant("eha");
  for (const ParameterDescription& p : plant.parameters)
    asset.parameters[p.name] = {.value = p.value, .min = p.min, .max = p.max, .estimate = p.estimate};
  for (const ChannelDescription& c : plant.channels)
    asset.sensors[c.name] = {.noise_std = c.noise_std, .time_constant_s = 0.0};
  return asset;
}

template <class F>
double seconds(const F& f) {
  const auto begin = std::chrono::steady_clock::now();
  f();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

struct Column {
  LawColumn law;
  std::string element;
};

std::vector<Column> columns_of(const PlantSimulation& simulation) {
  std::vector<Column> all;
  const auto candidates = find_candidates(simulation, {}, Laws::listed);
  for (const PassColumn& column : pass_columns(candidates)) {
    const Candidate& candidate = candidates[column.candidate];
    if (candidate.sites.empty() || candidate.law->hidden) continue;
    all.push_back({{.law = candidate.law,
                    .sites = candidate.sites,
                    .parameters = candidate.grid[column.point],
                    .strength = column.strength,
                    .unit = column.unit},
                   candidate.element});
  }
  return all;
}

// The simulation with a little of one law, minus the one without, over that little.
Eigen::VectorXd by_difference(const AssetConfig& asset, const TimeSeries& recorded, const ModelValues& start,
                              const Column& column, const SimulatedOutputs& without, Eigen::Index channel) {
  AssetConfig with = asset;
  PhysicsTerm term{.id = std::string(column.law.law->id), .element = column.element, .parameters = {}};
  for (std::size_t k = 0; k < column.law.parameters.size(); ++k) {
    const LawParameter& parameter = column.law.law->parameters[k];
    double value = column.law.parameters[k];
    if (parameter.strength) value = k == column.law.strength ? kLittle * column.law.unit : 0.0;
    term.parameters[std::string(parameter.name)] = {value, parameter.min, parameter.max, true};
  }
  with.physics = {term};
  const auto simulation = PlantSimulation::create(with, recorded);
  if (!simulation) return {};
  ModelValues values = (*simulation)->start();
  values.initial_state = start.initial_state;
  values.load_factor = start.load_factor;
  const auto outputs = (*simulation)->run(values, {}, kTight);
  if (!outputs) return {};
  return (outputs->values.col(channel) - without.values.col(channel)) / kLittle;
}

// Median over the columns of |a - b| / |a|.
double typical_deviation(const RowMatrix& a, const RowMatrix& b) {
  std::vector<double> deviations;
  for (Eigen::Index c = 0; c < a.cols(); ++c)
    if (a.col(c).norm() > 0.0) deviations.push_back((a.col(c) - b.col(c)).norm() / a.col(c).norm());
  std::ranges::nth_element(deviations, deviations.begin() + static_cast<std::ptrdiff_t>(deviations.size() / 2));
  return deviations[deviations.size() / 2];
}

}  // namespace

int main() {
  const AssetConfig asset = asset_without_lags();
  const TimeSeries recorded =
      bench::simulate_test(asset, bench::pst_profile({}), {.parameters = {}, .load_factor = 0.1}, {}).value().samples;
  const auto simulation = PlantSimulation::create(asset, recorded);
  if (!simulation) return std::puts(simulation.error().describe().c_str()), 3;
  const std::vector<Column> columns = columns_of(**simulation);
  std::vector<LawColumn> laws;
  for (const Column& column : columns) laws.push_back(column.law);
  // All states given, so that every way starts from the same point.
  ModelValues values = (*simulation)->start();
  std::vector<FreeQuantity> free;
  for (const std::string& state : (*simulation)->state_names())
    free.push_back((*simulation)->find("initial:" + state).value());
  const auto channels = (*simulation)->channels();
  const Eigen::Index position = std::ranges::find(channels, "position") - channels.begin();
  const auto samples = static_cast<Eigen::Index>(recorded.time_s.size());
  const auto count = static_cast<Eigen::Index>(columns.size());

  RowMatrix pass(samples, count), difference(samples, count);
  double pass_s = 1e9;
  for (int repetition = 0; repetition < 3; ++repetition)
    pass_s = std::min(
        pass_s, seconds([&] {
          LawColumns injected(laws, (*simulation)->plant());
          const auto outputs = (*simulation)->run(values, free, {}, &injected);
          for (Eigen::Index row = 0; outputs && row < samples; ++row)
            pass.row(row) =
                outputs->sensitivities.row(row * static_cast<Eigen::Index>(channels.size()) + position).tail(count);
        }));
  const double difference_s = seconds([&] {
    const auto without = (*simulation)->run(values, {}, kTight);
    for (Eigen::Index c = 0; without && c < count; ++c) {
      const Eigen::VectorXd column =
          by_difference(asset, recorded, values, columns[static_cast<std::size_t>(c)], *without, position);
      difference.col(c) = column.size() > 0 ? column : Eigen::VectorXd::Zero(samples);
    }
  });
  perf::CvodesRun cvodes;
  const double cvodes_s = seconds([&] {
    LawColumns injected(laws, (*simulation)->plant());
    cvodes = perf::sensitivities_by_cvodes(values, recorded, SimulationOptions{}.relative_tolerance, injected);
  });
  std::printf("%ld columns of laws without memory, %ld samples\n", static_cast<long>(count),
              static_cast<long>(samples));
  std::printf("  the pass     %8.3f s\n", pass_s);
  std::printf("  differences  %8.3f s   %6.1f times the pass; columns differ by %.2g (median)\n", difference_s,
              difference_s / pass_s, typical_deviation(pass, difference));
  std::printf("  CVODES       %8.3f s   %6.1f times the pass; columns differ by %.2g (median), %ld steps\n", cvodes_s,
              cvodes_s / pass_s, typical_deviation(pass, cvodes.position), cvodes.steps);
  const bool met = pass_s < difference_s && pass_s < cvodes_s;
  std::printf("goal: faster than both: %s\n", met ? "met" : "MISSED");
  return met ? 0 : 1;
}

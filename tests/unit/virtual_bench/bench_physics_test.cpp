// Laws of an asset's `physics` on the bench: the estimator's own simulation, driven by the recorded voltage, must show
// the same with the law, and something else without it.
#include "services/virtual_bench/bench_physics.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sealwatch/model/simulation.hpp"
#include "tests/unit/virtual_bench/nominal.hpp"

namespace sealwatch::bench {
namespace {

using ::testing::HasSubstr;

PhysicsTerm usual(const Law& law, const std::string& element) {
  PhysicsTerm term{.id = std::string(law.id), .element = element, .parameters = {}};
  for (const LawParameter& parameter : law.parameters)
    term.parameters[std::string(parameter.name)] = {parameter.start.front(), parameter.min, parameter.max, true};
  // Sizes for a velocity of 1.33 mm/s.
  if (law.kind == SiteKind::sensor_bias) term.parameters["b"].value = 1e-4;
  if (law.kind == SiteKind::sensor_drift) term.parameters["D"].value = 1e-4;
  if (law.kind == SiteKind::sensor_saturation) term.parameters["y_max"].value = 1e-3;
  if (law.kind == SiteKind::input_bias) term.parameters["b"].value = 1.0;
  return term;
}

/// Rms of simulation minus recording of the worst channel, in standard deviations of its sensor's noise.
double worst_misfit(const AssetConfig& asset, const TimeSeries& recorded) {
  const auto simulation = PlantSimulation::create(asset, recorded);
  EXPECT_TRUE(simulation) << simulation.error().describe();
  if (!simulation) return 0.0;
  ModelValues values = (*simulation)->start();
  values.load_factor = 0.0;  // as it is; the first pressures would take a law's force for load
  const auto outputs = (*simulation)->run(values, {}, {.relative_tolerance = 1e-7});
  EXPECT_TRUE(outputs) << outputs.error().describe();
  if (!outputs) return 0.0;
  double worst = 0.0;
  for (std::size_t c = 0; c < (*simulation)->channels().size(); ++c) {
    const auto column = static_cast<Eigen::Index>(c);
    const Eigen::VectorXd difference = outputs->values.col(column) - (*simulation)->recorded().col(column);
    const double sigma = (*find_plant("eha"))->find_channel((*simulation)->channels()[c])->noise_std;
    worst = std::max(worst, std::sqrt(difference.squaredNorm() / static_cast<double>(difference.size())) / sigma);
  }
  return worst;
}

TEST(BenchPhysics, EveryLawActsAsTheEstimatorKnowsIt) {
  constexpr double kSame = 0.2, kOther = 5.0;  // of the noise; times that
  const PlantDescription& plant = **find_plant("eha");
  int laws = 0, shown = 0;
  for (const Law& law : all_laws()) {
    std::string element = is_sensor(law.kind) ? "sensor:velocity" : "";
    if (is_of_recording(law.kind)) element = law.kind == SiteKind::clock_rate ? "clock" : "input:motor_voltage";
    for (const Site& site : plant.sites)
      if (element.empty() && fits(law, site)) element = site.element;
    if (element.empty()) continue;  // of another plant
    AssetConfig asset = quiet_asset();
    asset.physics = {usual(law, element)};
    const Recording recording = run(asset);
    const double with = worst_misfit(asset, recording.samples),
                 without = worst_misfit(quiet_asset(), recording.samples);
    EXPECT_LT(with, kSame) << law.id << " " << law.form << " at " << element;
    ++laws;
    shown += without > kOther * with ? 1 : 0;
  }
  EXPECT_GT(laws, 70);
  EXPECT_GE(shown, laws - 2) << "a pole is not saturated, a seat's memory not felt at their usual size";
}

TEST(BenchPhysics, ALawWithoutAPlaceIsAnError) {
  AssetConfig asset = nominal_asset();
  asset.physics = {usual(**find_law("coulomb_friction", {"F_c", "v_s"}), "pump")};
  const auto recording = simulate_test(asset, pst_profile(asset.pst), {}, {});
  ASSERT_FALSE(recording);
  EXPECT_THAT(recording.error().describe(), HasSubstr("coulomb_friction at pump"));
}

}  // namespace
}  // namespace sealwatch::bench

#include "services/virtual_bench/closed_loop.hpp"

#include <gtest/gtest.h>

#include "tests/unit/virtual_bench/nominal.hpp"

namespace sealwatch::bench {
namespace {

ClosedLoop nominal_loop() {
  const PlantDescription& plant = *find_plant("eha").value();
  ClosedLoop loop;
  EhaParameters<double>::visit(
      [&plant](std::string_view name, double& value) {
        if (const ParameterDescription* described = plant.find_parameter(name)) value = described->value;
      },
      loop.parameters);
  loop.parameters.load_factor = 0.1;
  loop.sensors = find_sensors(nominal_asset(), plant, default_channels()).value();
  return loop;
}

std::vector<double> times() {
  std::vector<double> out;
  for (int k = 0; k <= 3100; ++k) out.push_back(0.01 * k);
  return out;
}

TEST(ClosedLoop, IsAccurateFarBelowTheSensorsNoise) {
  ClosedLoop loop = nominal_loop();
  const auto usual = integrate(loop, pst_profile({}), times()).value();
  loop.relative_tolerance *= 1e-3;
  const auto fine = integrate(loop, pst_profile({}), times()).value();
  for (std::size_t k = 0; k < loop.sensors.size(); ++k) {
    // The voltage command has no noise; it is as good as its sensor would be with 10 mV in 60 V.
    const double own = loop.sensors[k].setting.noise_std;
    const double allowed = 0.1 * (own > 0.0 ? own : 0.01);
    for (std::size_t sample = 0; sample < usual[k].size(); ++sample)
      ASSERT_NEAR(usual[k][sample], fine[k][sample], allowed) << loop.sensors[k].channel << " at sample " << sample;
  }
}

TEST(ClosedLoop, StartsAtRest) {
  const ClosedLoop loop = nominal_loop();
  const auto values = integrate(loop, pst_profile({}), {0.0, 0.5, 1.0}).value();
  for (std::size_t k = 0; k < loop.sensors.size(); ++k) {
    if (loop.sensors[k].setting.noise_std <= 0.0) continue;
    EXPECT_NEAR(values[k][0], values[k][2], 0.5 * loop.sensors[k].setting.noise_std) << loop.sensors[k].channel;
  }
}

TEST(ClosedLoop, HopelessParametersAreAnError) {
  ClosedLoop loop = nominal_loop();
  loop.parameters.m_C = std::nan("");
  EXPECT_FALSE(integrate(loop, pst_profile({}), times()));
}

}  // namespace
}  // namespace sealwatch::bench

// The public recordings: known parameters of an independent bench program, and a life of 105 tests.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "sealwatch/estimation/actuator_fit.hpp"
#include "sealwatch/estimation/cylinder_circuit.hpp"
#include "tests/unit/estimation/recordings.hpp"

namespace sealwatch {
namespace {

const EstimatedParameter& parameter(const FitReport& report, const std::string& name) {
  for (const EstimatedParameter& candidate : report.parameters)
    if (candidate.name == name) return candidate;
  throw std::out_of_range(name);
}

TEST(SharedData, ConsistentCaseGivesItsTrueParameters) {
  const auto files = test::recordings_in(test::shared_data("bench_cases/consistent"));
  if (files.empty()) GTEST_SKIP() << "shared data are not here";
  // truth.json of that case. phi is not comparable: each recording has its own load.
  const std::map<std::string, double> truth = {{"R_CL", 2.65e13}, {"f_C", 1.856e6},  {"R_PL", 4.082e13},
                                               {"f_M", 1.021e-3}, {"beta", 1.001e9}, {"R_M", 0.4988}};
  std::vector<TimeSeries> recordings;
  for (const auto& file : files)
    if (file.filename().string().starts_with("fit_")) recordings.push_back(test::read_recording(file));
  const JointFit fit = fit_actuator(test::nominal_asset(), recordings);
  EXPECT_TRUE(fit.report.admissible) << testing::PrintToString(fit.report.reasons);
  constexpr double kSigmas = 3.0;
  for (const auto& [name, value] : truth)
    EXPECT_NEAR(parameter(fit.report, name).value, value, kSigmas * parameter(fit.report, name).std_error) << name;
}

TEST(SharedData, EveryMonthOfALifeHasAnEstimateOrAReason) {
  const auto files = test::recordings_in(test::shared_data("pst_life/xt03-mv2"));
  if (files.empty()) GTEST_SKIP() << "shared data are not here";
  const AssetConfig asset = test::nominal_asset();
  std::vector<double> resistance;
  for (const auto& file : files) {
    const FitReport circuit = fit_cylinder_circuit(asset, test::read_recording(file), {});
    if (!circuit.admissible) {
      EXPECT_FALSE(circuit.reasons.empty()) << file;
      continue;
    }
    EXPECT_TRUE(std::isfinite(parameter(circuit, "R_CL").std_error)) << file;
    resistance.push_back(parameter(circuit, "R_CL").value);
  }
  constexpr std::size_t kMostLeftOut = 3;  // one test of the life was cut short
  EXPECT_GE(resistance.size() + kMostLeftOut, files.size());
  EXPECT_LT(resistance.back(), 0.5 * resistance.front()) << "the seal ages";
}

TEST(SharedData, WholeActuatorAndCylinderCircuitAgreeOnWornAndNewSeals) {
  const auto files = test::recordings_in(test::shared_data("pst_life/xt03-mv2"));
  if (files.empty()) GTEST_SKIP() << "shared data are not here";
  const AssetConfig asset = test::nominal_asset();
  constexpr std::size_t kEvery = 20;
  constexpr double kSigmas = 4.0;
  for (std::size_t k = 0; k < files.size(); k += kEvery) {
    const TimeSeries samples = test::read_recording(files[k]);
    const FitReport whole = fit_actuator(asset, {&samples, 1}).report;
    ASSERT_TRUE(whole.admissible) << files[k] << testing::PrintToString(whole.reasons);
    const FitReport circuit = fit_cylinder_circuit(asset, samples, {});
    const EstimatedParameter &a = parameter(whole, "R_CL"), &b = parameter(circuit, "R_CL");
    EXPECT_NEAR(a.value, b.value, kSigmas * std::hypot(a.std_error, b.std_error)) << files[k];
    TimeSeries without_flow = samples;
    std::erase_if(without_flow.channels, [](const Series& channel) { return channel.name == "flow"; });
    const FitReport blind = fit_actuator(asset, {&without_flow, 1}).report;
    ASSERT_TRUE(blind.admissible) << files[k] << testing::PrintToString(blind.reasons);
    const EstimatedParameter& c = parameter(blind, "R_CL");
    EXPECT_NEAR(c.value, b.value, kSigmas * std::hypot(c.std_error, b.std_error)) << files[k] << " without flow";
  }
}

}  // namespace
}  // namespace sealwatch

// Every law at every site of the plants: sensitivities of a law in force against differences of whole simulations, and
// the injected column of an absent law against the simulation with a little of it.
#include "services/common/model/law_columns.hpp"

#include <gtest/gtest.h>

#include "tests/unit/model/standard_pst.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kNoise = 2e-3;  // of the differences: the integrator's own error over the step
constexpr SimulationOptions kTight = {.relative_tolerance = 1e-9, .maximum_step_s = 5e-3};

struct Case {
  const Law* law;
  std::string element;
  std::vector<std::size_t> sites;
};

std::vector<Case> cases(const std::string& model) {
  std::vector<Case> all;
  const auto& sites = (*find_plant(model))->sites;
  for (const Law& law : all_laws())
    for (std::size_t k = 0; k < sites.size(); ++k) {
      if (sites[k].kind != law.kind) continue;
      const std::string element(sites[k].element);
      const bool known = !all.empty() && all.back().law == &law && all.back().element == element;
      if (known)
        all.back().sites.push_back(k);
      else
        all.push_back({&law, element, {k}});
    }
  return all;
}

PhysicsTerm term_of(const Case& which, double share) {
  PhysicsTerm term{.id = std::string(which.law->id), .element = which.element, .parameters = {}};
  for (const LawParameter& parameter : which.law->parameters)
    term.parameters[std::string(parameter.name)] = {
        parameter.strength ? share * parameter.start.front() : parameter.start.front(), parameter.min, parameter.max,
        true};
  return term;
}

AssetConfig without_lags() {
  AssetConfig asset = nominal_asset("eha");
  for (auto& [channel, sensor] : asset.sensors) sensor.time_constant_s = 0.0;
  return asset;
}

double norm(const RowMatrix& matrix, Eigen::Index channel) { return matrix.col(channel).norm(); }

TEST(LawColumns, AreTheChangeThatALittleOfTheLawMakes) {
  const AssetConfig asset = without_lags();
  const TimeSeries recorded = standard_pst(asset, 100.0, 4.0);
  const auto plain = PlantSimulation::create(asset, recorded);
  ASSERT_TRUE(plain);
  const auto before = (*plain)->run((*plain)->start(), {}, kTight);
  ASSERT_TRUE(before);
  for (const Case& which : cases("eha")) {
    std::vector<double> parameters;
    for (const LawParameter& parameter : which.law->parameters) parameters.push_back(parameter.start.front());
    const std::size_t strength = static_cast<std::size_t>(
        std::ranges::find_if(which.law->parameters, &LawParameter::strength) - which.law->parameters.begin());
    // Oil lost from a chamber at rest moves its valve: a strong effect, and far from linear.
    const double kLittle = which.law->kind == SiteKind::outflow ? 2e-5 : 1e-3;
    const bool turns = which.law->hidden && which.law->hidden->shaft_angle;  // many periods in every step
    const SimulationOptions tight = {.relative_tolerance = 1e-9, .maximum_step_s = turns ? 5e-4 : 5e-3};
    AssetConfig with = asset;
    with.physics = {term_of(which, kLittle)};
    for (auto& [name, setting] : with.physics[0].parameters)
      if (name != which.law->parameters[strength].name && which.law->parameters[0].strength)
        for (const LawParameter& parameter : which.law->parameters)
          if (parameter.name == name && parameter.strength) setting.value = 0.0;  // one strength at a time
    const auto simulation = PlantSimulation::create(with, recorded);
    ASSERT_TRUE(simulation) << simulation.error().describe();
    const auto after = (*simulation)->run((*simulation)->start(), {}, tight);
    ASSERT_TRUE(after) << which.law->id;
    LawColumns columns({{.law = which.law,
                         .sites = which.sites,
                         .parameters = parameters,
                         .strength = strength,
                         .unit = parameters[strength]}},
                       (*plain)->plant());
    const auto injected = (*plain)->run((*plain)->start(), {}, tight, &columns);
    ASSERT_TRUE(injected) << which.law->id;
    const Eigen::Index channels = before->values.cols();
    double size = 0.0, error = 0.0;
    for (Eigen::Index c = 0; c < channels; ++c) {
      const double scale = std::max(norm(before->values, c), 1e-9);
      for (Eigen::Index row = 0; row < before->values.rows(); ++row) {
        const double difference = (after->values(row, c) - before->values(row, c)) / kLittle;
        const double column = injected->sensitivities(row * channels + c, 0);
        size += std::pow(difference / scale, 2);
        error += std::pow((difference - column) / scale, 2);
      }
    }
    EXPECT_LT(std::sqrt(error), 0.1 * std::sqrt(size) + kNoise)
        << which.law->id << " " << which.law->form << " at " << which.element << ", size " << std::sqrt(size);
  }
}

// Columns in steps of usual exactness, no longer than that, against those in fine ones; channels in units of their noise.
void expect_exact_columns(const std::vector<Case>& asked, const AssetConfig& asset, const TimeSeries& recorded,
                          double longest_step_s) {
  const auto simulation = PlantSimulation::create(asset, recorded);
  ASSERT_TRUE(simulation);
  std::vector<LawColumn> laws;
  for (const Case& which : asked) {
    std::vector<double> parameters;
    for (const LawParameter& parameter : which.law->parameters) parameters.push_back(parameter.start.front());
    const auto first = std::ranges::find_if(which.law->parameters, &LawParameter::strength);
    const auto strength = static_cast<std::size_t>(first - which.law->parameters.begin());
    laws.push_back({.law = which.law,
                    .sites = which.sites,
                    .parameters = parameters,
                    .strength = strength,
                    .unit = parameters[strength]});
  }
  const auto columns_with = [&](const SimulationOptions& options) {
    LawColumns columns(laws, (*simulation)->plant());
    const auto outputs = (*simulation)->run((*simulation)->start(), {}, options, &columns);
    return outputs ? outputs->sensitivities : RowMatrix();
  };
  const RowMatrix usual = columns_with({.maximum_step_s = longest_step_s}),
                  exact = columns_with({.relative_tolerance = 1e-9, .maximum_step_s = 0.2 * longest_step_s});
  ASSERT_EQ(usual.cols(), std::ssize(asked));
  ASSERT_EQ(exact.cols(), std::ssize(asked));
  const auto channels = (*simulation)->channels();
  for (std::size_t k = 0; k < asked.size(); ++k) {
    double size = 0.0, error = 0.0;
    for (Eigen::Index row = 0; row < exact.rows(); ++row) {
      const auto column = static_cast<Eigen::Index>(k);
      const double noise = asset.sensors.at(channels[static_cast<std::size_t>(row) % channels.size()]).noise_std;
      size += std::pow(exact(row, column) / noise, 2);
      error += std::pow((usual(row, column) - exact(row, column)) / noise, 2);
    }
    EXPECT_LT(std::sqrt(error), 0.1 * std::sqrt(size) + 0.01)
        << asked[k].law->id << " " << asked[k].law->form << " at " << asked[k].element << ", size " << std::sqrt(size);
  }
}

bool turns(const Case& which) { return which.law->hidden && which.law->hidden->shaft_angle; }

// Outputs lie between the ends of steps. The flow through a valve that hardly resists is the small difference of what a
// line takes and of what the pressures do about it. (Laws that turn with the shaft make many turns in such a step.)
TEST(LawColumns, AreAsExactInTheStepsThatASimulationUsuallyTakes) {
  const AssetConfig asset = without_lags();
  std::vector<Case> asked = cases("eha");
  std::erase_if(asked, turns);
  expect_exact_columns(asked, asset, standard_pst(asset, 100.0), 0.02);
}

// The last step before a jump goes beyond it.
TEST(LawColumns, TurnNoFurtherThanTheShaftWhereTheInputJumps) {
  const AssetConfig asset = without_lags();
  std::vector<Case> asked = cases("eha");
  std::erase_if(asked, [](const Case& which) { return !turns(which); });
  ASSERT_FALSE(asked.empty());
  TimeSeries recorded = standard_pst(asset, 200.0, 4.0);
  recorded.input_hold = true;
  expect_exact_columns(asked, asset, recorded, 7e-4);
}

TEST(LawsInForce, HaveSensitivitiesThatAgreeWithDifferences) {
  const AssetConfig asset = without_lags();
  const TimeSeries recorded = standard_pst(asset, 100.0, 4.0);
  for (const Case& which : cases("eha")) {
    AssetConfig with = asset;
    with.physics = {term_of(which, 0.1)};
    const auto simulation = PlantSimulation::create(with, recorded);
    ASSERT_TRUE(simulation) << simulation.error().describe();
    std::vector<FreeQuantity> free = {(*simulation)->find("R_CL").value(), (*simulation)->find("initial:p_A").value()};
    for (const PhysicsParameter& parameter : (*simulation)->physics_parameters())
      if (parameter.name != "shaft.cogging_torque.N")  // a whole number: never estimated
        free.push_back((*simulation)->find(parameter.name).value());
    const ModelValues values = (*simulation)->start();
    const auto outputs = (*simulation)->run(values, free, kTight);
    ASSERT_TRUE(outputs) << which.law->id << " " << which.law->form << " at " << which.element << ": "
                         << outputs.error().describe();
    const Eigen::Index channels = outputs->values.cols();
    for (std::size_t k = 0; k < free.size(); ++k) {
      ModelValues up = values, down = values;
      const double step = (k == 1 ? 1e-4 : 1e-2) * std::abs(free[k].in(values));
      free[k].in(up) += step;
      free[k].in(down) -= step;
      const auto after = (*simulation)->run(up, {}, kTight), before = (*simulation)->run(down, {}, kTight);
      ASSERT_TRUE(after && before);
      double size = 0.0, error = 0.0;
      for (Eigen::Index c = 0; c < channels; ++c) {
        const double scale = std::max(norm(outputs->values, c), 1e-9) / step;
        for (Eigen::Index row = 0; row < outputs->values.rows(); ++row) {
          const double difference = (after->values(row, c) - before->values(row, c)) / (2.0 * step);
          const double slope = outputs->sensitivities(row * channels + c, static_cast<Eigen::Index>(k));
          size += std::pow(difference / scale, 2);
          error += std::pow((difference - slope) / scale, 2);
        }
      }
      EXPECT_LT(std::sqrt(error), 0.1 * std::sqrt(size) + kNoise)
          << which.law->id << " " << which.law->form << " at " << which.element << ", quantity " << k << ", size "
          << std::sqrt(size);
    }
  }
}

}  // namespace
}  // namespace sealwatch::mismatch

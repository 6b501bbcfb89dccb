// The plants' equations: names shared with the tables, derivatives by dual numbers against central differences at many
// states (end stops and closed valves among them), conservation of volume.
#include <gtest/gtest.h>

#include <random>

#include "sealwatch/model/cascaded_tanks.hpp"
#include "sealwatch/model/eha.hpp"
#include "sealwatch/model/eha_switched.hpp"
#include "sealwatch/model/emps.hpp"
#include "sealwatch/model/plant_description.hpp"

namespace sealwatch {
namespace {

template <class Parameters>
std::vector<std::string> field_names() {
  std::vector<std::string> names;
  Parameters parameters{};
  parameters.visit([&](std::string_view name, auto&) { names.emplace_back(name); }, parameters);
  return names;
}

template <class Scalar, template <class> class Parameters>
Parameters<Scalar> nominal(const std::string& plant, double load_factor) {
  Parameters<Scalar> parameters{};
  const auto& table = find_plant(plant).value()->parameters;
  std::size_t index = 0;
  parameters.visit(
      [&](std::string_view, Scalar& value) {
        value = index < table.size() ? table[index].value : load_factor;
        ++index;
      },
      parameters);
  return parameters;
}

TEST(PlantTables, HaveTheNamesAndOrderOfTheEquationsParameters) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> plants = {
      {"eha", field_names<EhaParameters<double>>()},
      {"eha_switched", field_names<EhaSwitchedParameters<double>>()},
      {"emps", field_names<EmpsParameters<double>>()},
      {"cascaded_tanks", field_names<CascadedTanksParameters<double>>()}};
  ASSERT_EQ(plants.size(), all_plants().size());
  for (const auto& [plant, fields] : plants) {
    const auto& table = find_plant(plant).value()->parameters;
    ASSERT_EQ(table.size() + 1, fields.size()) << plant;
    for (std::size_t k = 0; k < table.size(); ++k) EXPECT_EQ(table[k].name, fields[k]) << plant;
    EXPECT_EQ(fields.back(), "load_factor");
  }
}

TEST(PlantTables, HaveDefaultsWithinBoundsAndUnits) {
  for (const PlantDescription& plant : all_plants())
    for (const ParameterDescription& parameter : plant.parameters) {
      EXPECT_LE(parameter.min, parameter.value) << plant.name << " " << parameter.name;
      EXPECT_GE(parameter.max, parameter.value) << plant.name << " " << parameter.name;
      EXPECT_FALSE(parameter.unit.empty() || parameter.meaning.empty()) << plant.name << " " << parameter.name;
      EXPECT_TRUE(!parameter.positive || parameter.min > 0.0) << plant.name << " " << parameter.name;
    }
}

TEST(PlantTables, NameTheNearestPlant) {
  const auto plant = find_plant("ehx");
  ASSERT_FALSE(plant);
  EXPECT_NE(plant.error().describe().find("'eha'"), std::string::npos) << plant.error().describe();
}

/// One random state between the rows `low` and `high`.
template <class Plant>
std::array<double, Plant::kStates> random_state(std::mt19937& random, const std::array<double, Plant::kStates>& low,
                                                const std::array<double, Plant::kStates>& high) {
  std::array<double, Plant::kStates> state;
  for (int k = 0; k < Plant::kStates; ++k) state[k] = std::uniform_real_distribution(low[k], high[k])(random);
  return state;
}

/// Central difference over a small relative step, compared with the dual number's slope. Tolerance: the differences'
/// own error, which is large where a stiff law bends within the step.
constexpr double kDifferenceError = 2e-4;

void expect_close(double slope, double difference, double size, const std::string& where) {
  EXPECT_NEAR(slope, difference, kDifferenceError * std::max({std::abs(slope), std::abs(difference), size})) << where;
}

template <class Plant, template <class> class Parameters>
void check_jacobian(const std::string& name, const typename Plant::Input& input,
                    const std::array<double, Plant::kStates>& low, const std::array<double, Plant::kStates>& high) {
  constexpr int kStates = Plant::kStates;
  std::mt19937 random(7);
  const auto parameters = nominal<double, Parameters>(name, 0.1);
  for (int trial = 0; trial < 40; ++trial) {
    const auto state = random_state<Plant>(random, low, high);
    std::array<Dual<kStates>, kStates> dual;
    for (int k = 0; k < kStates; ++k) dual[k] = Dual<kStates>::variable(state[k], k);
    const auto exact = Plant::derivatives(dual, input, parameters);
    const auto value = Plant::derivatives(state, input, parameters);
    for (int row = 0; row < kStates; ++row) EXPECT_NEAR(exact[row].value, value[row], 1e-12 * std::abs(value[row]));
    for (int column = 0; column < kStates; ++column) {
      const double step = 1e-6 * (high[column] - low[column]);
      auto up = state, down = state;
      up[column] += step;
      down[column] -= step;
      const auto after = Plant::derivatives(up, input, parameters),
                 before = Plant::derivatives(down, input, parameters);
      for (int row = 0; row < kStates; ++row)
        expect_close(exact[row].derivative[column], (after[row] - before[row]) / (2.0 * step),
                     1e-7 * std::abs(value[row]) / step,
                     name + " d" + std::to_string(row) + "/d" + std::to_string(column));
    }
  }
}

TEST(EhaEquations, JacobianAgreesWithDifferences) {
  check_jacobian<Eha, EhaParameters>("eha", {5.0}, {-20, -10, -200, 2e5, 2e5, 2e5, 2e5, -2e-3, 1e-3},
                                     {20, 10, 200, 1.5e7, 1.5e7, 1.5e7, 1.5e7, 2e-3, 0.079});
}

TEST(EhaSwitchedEquations, JacobianAgreesWithDifferencesInEveryValveState) {
  for (const double valve : {-1.0, 0.0, 1.0})
    check_jacobian<EhaSwitched, EhaSwitchedParameters>("eha_switched", {0.3, valve},
                                                       {-5, -5, 0, -5e4, -5e4, -5e4, 1.5e5, -0.02, -1e-4},
                                                       {20, 200, 100, 4e6, 4e6, 4e6, 1e6, 0.02, 0.0751});
}

template <class Plant, template <class> class Parameters>
void check_parameter_derivatives(const std::string& name, const typename Plant::Input& input,
                                 const std::array<double, Plant::kStates>& state) {
  const auto names = field_names<Parameters<double>>();
  for (std::size_t which = 0; which < names.size(); ++which) {
    auto dual = nominal<Dual<1>, Parameters>(name, 0.1);
    auto up = nominal<double, Parameters>(name, 0.1), down = up;
    double step = 0.0;
    std::size_t index = 0;
    dual.visit_pair(
        [&](std::string_view, Dual<1>& seed, double& value) {
          if (index++ != which) return;
          seed.derivative[0] = 1.0;
          step = 1e-6 * std::max(std::abs(value), 1.0 * (value == 0.0));
          value += step;
        },
        dual, up);
    index = 0;
    down.visit([&](std::string_view, double& value) { value -= index++ == which ? step : 0.0; }, down);
    const auto exact = Plant::derivatives(state, input, dual);
    const auto after = Plant::derivatives(state, input, up), before = Plant::derivatives(state, input, down);
    for (int row = 0; row < Plant::kStates; ++row)
      expect_close(exact[row].derivative[0], (after[row] - before[row]) / (2.0 * step),
                   1e-7 * std::abs(after[row]) / step, name + " d" + std::to_string(row) + "/d" + names[which]);
  }
}

TEST(EhaEquations, ParameterDerivativesAgreeWithDifferences) {
  check_parameter_derivatives<Eha, EhaParameters>("eha", {5.0}, {4, 2, 50, 1.05e7, 1.02e6, 1.0e7, 1.0e6, 1e-3, 0.05});
  check_parameter_derivatives<Eha, EhaParameters>("eha", {-5.0},
                                                  {-4, -1, -50, 1.0e6, 6.0e6, 9.0e6, 5.9e6, -1e-3, 1e-3});
}

TEST(EhaSwitchedEquations, ParameterDerivativesAgreeWithDifferences) {
  check_parameter_derivatives<EhaSwitched, EhaSwitchedParameters>("eha_switched", {0.3, 1.0},
                                                                  {5, 80, 3, 1.1e6, 1.0e6, 2.6e5, 2.5e5, 0.01, 0.02});
  check_parameter_derivatives<EhaSwitched, EhaSwitchedParameters>("eha_switched", {-0.3, -1.0},
                                                                  {5, 80, 3, 1.1e6, 3.0e5, 9e5, 2.5e5, -0.01, 1e-5});
}

// Oil is neither made nor lost: the compressed volumes change by the make-up flows and the piston's displacement alone.
TEST(EhaEquations, ConserveVolume) {
  const auto p = nominal<double, EhaParameters>("eha", 0.0);
  std::mt19937 random(3);
  for (int trial = 0; trial < 100; ++trial) {
    const auto y = random_state<Eha>(random, {-20, -10, -200, 2e5, 2e5, 2e5, 2e5, -2e-3, 5e-3},
                                     {20, 10, 200, 1.5e7, 1.5e7, 1.5e7, 1.5e7, 2e-3, 0.075});
    const auto rate = Eha::derivatives(y, {1.0}, p);
    const double V_A = p.V_0 + p.A_C * y[Eha::kX], V_B = p.V_0 + p.A_C * p.area_ratio * (p.x_C - y[Eha::kX]);
    const double compressed =
        (p.V_P * (rate[Eha::kP1] + rate[Eha::kP2]) + V_A * rate[Eha::kPA] + V_B * rate[Eha::kPB]) / p.beta;
    const double made_up =
        laws::make_up_flow(p.K_MU, p.p_0, y[Eha::kP1], p.s_MU) + laws::make_up_flow(p.K_MU, p.p_0, y[Eha::kP2], p.s_MU);
    const double displaced = (p.area_ratio - 1.0) * p.A_C * y[Eha::kV];
    EXPECT_NEAR(compressed, made_up + displaced, 1e-15) << "m3/s, of flows of 1e-5 m3/s";
  }
}

TEST(EhaSwitchedEquations, ConserveVolume) {
  const auto p = nominal<double, EhaSwitchedParameters>("eha_switched", 0.0);
  for (const double valve : {-1.0, 0.0, 1.0}) {
    const std::array<double, 9> y = {5, 80, 3, 1.1e6, 1.0e6, 5e5, 2.5e5, 0.01, 0.02};
    const auto rate = EhaSwitched::derivatives(y, {0.3, valve}, p);
    const double V_P = EhaSwitched::pipe_volume(p.l_supply, p), V_0 = p.V_0 + EhaSwitched::pipe_volume(p.l_chamber, p);
    const auto stored = [&](int state, double volume) {
      return volume / EhaSwitched::bulk_modulus(y[state], p) * rate[state];
    };
    const double sum = stored(EhaSwitched::kPP, V_P) + stored(EhaSwitched::kPA, V_0 + p.A_A * y[EhaSwitched::kX]) +
                       stored(EhaSwitched::kPB, V_0 + p.A_B * (p.x_C - y[EhaSwitched::kX])) +
                       stored(EhaSwitched::kPT, V_P) +
                       EhaSwitched::gas_compliance(y[EhaSwitched::kPT], p) * rate[EhaSwitched::kPT];
    EXPECT_NEAR(sum, (p.A_B - p.A_A) * y[EhaSwitched::kV], 1e-15) << "m3/s at valve state " << valve;
  }
}

}  // namespace
}  // namespace sealwatch

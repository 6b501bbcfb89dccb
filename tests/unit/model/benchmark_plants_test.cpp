// Plants `emps` and `cascaded_tanks`: equations against values computed by hand, simulation against closed forms,
// sensitivities against differences, what a bad recording is told.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sealwatch/model/cascaded_tanks.hpp"
#include "sealwatch/model/emps.hpp"
#include "sealwatch/model/simulation.hpp"
#include "tests/unit/model/recording_for_tests.hpp"

namespace sealwatch {
namespace {

constexpr SimulationOptions kTight = {.relative_tolerance = 1e-10, .maximum_steps = 2000000};

/// `rows` samples every `step_s`, the input as a function of time, the output a constant.
template <class Input>
TimeSeries recording_of(const char* input_name, Input input, const char* output_name, double output, int rows,
                        double step_s) {
  TimeSeries samples;
  samples.channels = {{input_name, "V", 0.0, {}}, {output_name, "", 0.0, {}}};
  for (int row = 0; row < rows; ++row) {
    samples.time_s.push_back(row * step_s);
    samples.channels[0].values.push_back(input(row * step_s));
    samples.channels[1].values.push_back(output);
  }
  return samples;
}

TEST(EmpsEquations, AreNewtonsLawOfTheCarriage) {
  const EmpsParameters<double> p{.M = 100.0, .F_v = 200.0, .k_F = 35.0, .load_factor = 0.0};
  const auto rate = Emps::derivatives<double, double>({0.1, 0.05}, {2.0}, p);
  EXPECT_DOUBLE_EQ(rate[Emps::kX], 0.05);
  EXPECT_DOUBLE_EQ(rate[Emps::kV], (35.0 * 2.0 - 200.0 * 0.05) / 100.0);
  // A volt lost in the driver and ten newtons of friction.
  const auto hindered = Emps::derivatives<double, double>({0.1, 0.05}, {2.0}, p, std::array{1.0, 10.0});
  EXPECT_DOUBLE_EQ(hindered[Emps::kV], (35.0 * 1.0 - 200.0 * 0.05 - 10.0) / 100.0);
}

TEST(CascadedTanksEquations, AreTorricellisOutflows) {
  const CascadedTanksParameters<double> p{.k4 = 0.05, .k1 = 0.06, .k3 = 0.07, .area_ratio = 2.0, .load_factor = 0.0};
  const auto rate = CascadedTanks::derivatives<double, double>({4.0, 9.0}, {3.0}, p);
  constexpr double kRounding = 1e-4;  // of the root near full tanks: half a millivolt of volts
  EXPECT_NEAR(rate[CascadedTanks::kUpper], 0.05 * 3.0 - 0.06 * 2.0, 0.12 * kRounding * 2.0);
  EXPECT_NEAR(rate[CascadedTanks::kLower], 2.0 * 0.06 * 2.0 - 0.07 * 3.0, 0.24 * kRounding * 2.0);
  const auto losing =
      CascadedTanks::derivatives<double, double>({4.0, 9.0}, {3.0}, p, std::array{1.0, 0.01, 0.003, -0.02});
  EXPECT_NEAR(losing[CascadedTanks::kUpper] - rate[CascadedTanks::kUpper], -0.05 - 0.01 - 0.003, 1e-15);
  EXPECT_NEAR(losing[CascadedTanks::kLower] - rate[CascadedTanks::kLower], 2.0 * 0.003 + 0.02, 1e-15);
}

// What leaves the upper tank arrives in the lower one: k4 u - q_2 is the sum of both volumes' rates.
TEST(CascadedTanksEquations, ConserveVolume) {
  const CascadedTanksParameters<double> p{.k4 = 0.05, .k1 = 0.06, .k3 = 0.07, .area_ratio = 2.0, .load_factor = 0.0};
  for (const double upper : {0.0, 1e-4, 1.0, 12.0}) {
    const auto rate = CascadedTanks::derivatives<double, double>({upper, 5.0}, {3.0}, p);
    const double outflow = p.k3 * laws::signed_root(5.0, CascadedTanks::kRoundedLevel_V);
    EXPECT_NEAR(p.area_ratio * rate[CascadedTanks::kUpper] + rate[CascadedTanks::kLower],
                p.area_ratio * p.k4 * 3.0 - outflow, 1e-15);
  }
}

TEST(CascadedTanksEquations, AreSmoothAtAnEmptyTank) {
  const auto root = [](double level) {
    return laws::signed_root(Dual<1>::variable(level, 0), CascadedTanks::kRoundedLevel_V);
  };
  EXPECT_DOUBLE_EQ(root(0.0).value, 0.0);
  EXPECT_NEAR(root(0.0).derivative[0], 1.0 / std::sqrt(CascadedTanks::kRoundedLevel_V), 1e-12);
  EXPECT_NEAR(root(1e-9).derivative[0], root(-1e-9).derivative[0], 1e-3);
  EXPECT_NEAR(root(4.0).derivative[0], 0.25, 1e-4);
}

// Constant voltage from rest: v = (F / F_v) (1 - exp(-t / tau)), x = (F / F_v) (t - tau (1 - exp(-t / tau))).
TEST(EmpsSimulation, AgreesWithTheClosedForm) {
  AssetConfig asset = nominal_asset("emps");
  const TimeSeries samples = recording_of(
      "motor_voltage", [](double) { return 2.0; }, "position", 0.0, 5001, 1e-3);
  const auto simulation = PlantSimulation::create(asset, samples);
  ASSERT_TRUE(simulation) << simulation.error().describe();
  const auto outputs = (*simulation)->run((*simulation)->start(), {});
  ASSERT_TRUE(outputs) << outputs.error().describe();
  const double tau = 95.11 / 203.5, speed = 35.15 * 2.0 / 203.5;
  constexpr double kResolved_m = 1e-9;  // a twentieth of the encoder's noise
  for (int row = 0; row <= 5000; row += 100) {
    const double t = 1e-3 * row;
    EXPECT_NEAR(outputs->values(row, 0), speed * (t - tau * (1.0 - std::exp(-t / tau))), kResolved_m) << t;
  }
}

// The controller holds its voltage. Means of neighbours, linear between samples, move the carriage as the held voltage
// does, and not as the recorded voltage that is taken as linear, which comes half a sample too early.
TEST(EmpsSimulation, TakesTheVoltageAsHeldWithoutStartingAnewAtEverySample) {
  const AssetConfig asset = nominal_asset("emps");
  TimeSeries samples = recording_of(
      "motor_voltage", [](double t) { return 2.0 * std::sin(2.0 * std::numbers::pi * t); }, "position", 0.0, 1001,
      1e-3);
  const auto smooth = PlantSimulation::create(asset, samples);
  samples.input_hold = true;
  const auto held = PlantSimulation::create(asset, samples);
  ASSERT_TRUE(smooth && held);
  const auto a = (*smooth)->run((*smooth)->start(), {}, kTight), b = (*held)->run((*held)->start(), {}, kTight);
  ASSERT_TRUE(a && b);
  constexpr double kHalfASample_s = 5e-4;
  const double fastest = (b->values.bottomRows(1000) - b->values.topRows(1000)).cwiseAbs().maxCoeff() / 1e-3;
  EXPECT_GT(fastest * kHalfASample_s, 5e-5) << "the difference that is at stake";
  EXPECT_LT((a->values - b->values).cwiseAbs().maxCoeff(), 2e-7);
  const auto usual = (*smooth)->run((*smooth)->start(), {}), usual_held = (*held)->run((*held)->start(), {});
  ASSERT_TRUE(usual && usual_held);
  EXPECT_LT(2 * usual->steps, usual_held->steps);
}

TEST(CascadedTanksSimulation, AgreesWithTheEmptyingTanksClosedForm) {
  AssetConfig asset = nominal_asset("cascaded_tanks");
  const TimeSeries samples = recording_of(
      "pump_voltage", [](double) { return 0.0; }, "level_voltage", 9.0, 26, 4.0);
  const auto simulation = PlantSimulation::create(asset, samples);
  ASSERT_TRUE(simulation) << simulation.error().describe();
  ModelValues values = (*simulation)->start();
  EXPECT_DOUBLE_EQ(values.initial_state[1], 9.0);
  EXPECT_NEAR(values.initial_state[0], 9.0, 1e-12) << "equal outlets hold equal levels";
  values.initial_state[0] = 0.0;  // nothing flows in: sqrt(x) = sqrt(x_0) - k3 t / 2
  const auto outputs = (*simulation)->run(values, {});
  ASSERT_TRUE(outputs) << outputs.error().describe();
  constexpr double kRounding_V = 1e-3;  // of the outflow's root, over the whole emptying
  for (int row = 0; row <= 25; ++row) {
    const double root = 3.0 - 0.05 * 4.0 * row / 2.0;
    EXPECT_NEAR(outputs->values(row, 0), root * root, 2.0 * kRounding_V) << 4.0 * row << " s";
  }
}

// The pump's voltage holds between samples whatever the recording says.
TEST(CascadedTanksSimulation, HoldsThePumpVoltage) {
  const AssetConfig asset = nominal_asset("cascaded_tanks");
  TimeSeries samples = recording_of(
      "pump_voltage", [](double t) { return t < 40.0 ? 2.0 : 4.0; }, "level_voltage", 4.0, 26, 4.0);
  const auto linear = PlantSimulation::create(asset, samples);
  samples.input_hold = true;
  const auto held = PlantSimulation::create(asset, samples);
  ASSERT_TRUE(linear && held);
  const auto a = (*linear)->run((*linear)->start(), {}), b = (*held)->run((*held)->start(), {});
  ASSERT_TRUE(a && b);
  EXPECT_EQ((a->values - b->values).cwiseAbs().maxCoeff(), 0.0);
}

/// Every parameter and every initial state against central differences of whole simulations.
void check_sensitivities(const PlantSimulation& simulation) {
  std::vector<FreeQuantity> free;
  for (const auto& parameter : simulation.plant().parameters) free.push_back(simulation.find(parameter.name).value());
  for (const auto& state : simulation.state_names()) free.push_back(simulation.find("initial:" + state).value());
  const ModelValues values = simulation.start();
  const auto outputs = simulation.run(values, free, kTight);
  ASSERT_TRUE(outputs) << outputs.error().describe();
  constexpr double kStep = 1e-4, kError = 1e-4;  // relative
  for (std::size_t k = 0; k < free.size(); ++k) {
    ModelValues up = values, down = values;
    const double size = std::abs(free[k].in(values)), step = kStep * (size > 0.0 ? size : 1.0);
    free[k].in(up) += step;
    free[k].in(down) -= step;
    const auto after = simulation.run(up, {}, kTight), before = simulation.run(down, {}, kTight);
    ASSERT_TRUE(after && before);
    const Eigen::VectorXd difference = (after->values - before->values).col(0) / (2.0 * step);
    ASSERT_GT(difference.norm(), 0.0) << k;
    EXPECT_LT((difference - outputs->sensitivities.col(static_cast<Eigen::Index>(k))).norm(),
              kError * difference.norm())
        << "quantity " << k;
  }
}

TEST(EmpsSimulation, SensitivitiesAgreeWithDifferences) {
  TimeSeries samples = recording_of(
      "motor_voltage", [](double t) { return 2.0 * std::sin(2.0 * std::numbers::pi * t); }, "position", 0.01, 1001,
      1e-3);
  for (std::size_t row = 0; row < samples.time_s.size(); ++row)
    samples.channels[1].values[row] += 0.02 * samples.time_s[row];  // so that it starts with a velocity
  const auto simulation = PlantSimulation::create(nominal_asset("emps"), samples);
  ASSERT_TRUE(simulation);
  check_sensitivities(**simulation);
}

TEST(CascadedTanksSimulation, SensitivitiesAgreeWithDifferences) {
  const auto simulation = PlantSimulation::create(
      nominal_asset("cascaded_tanks"),
      recording_of(
          "pump_voltage", [](double t) { return 2.5 + 1.5 * std::sin(0.03 * t); }, "level_voltage", 5.0, 101, 4.0));
  ASSERT_TRUE(simulation);
  check_sensitivities(**simulation);
}

TEST(BenchmarkPlants, HaveNoLoadAndSayWhatIsMissing) {
  for (const char* plant : {"emps", "cascaded_tanks"}) {
    const bool emps = std::string(plant) == "emps";
    const char *input = emps ? "motor_voltage" : "pump_voltage", *output = emps ? "position" : "level_voltage";
    TimeSeries samples = recording_of(
        input, [](double) { return 1.0; }, output, 1.0, 10, 1.0);
    const auto simulation = PlantSimulation::create(nominal_asset(plant), samples);
    ASSERT_TRUE(simulation) << simulation.error().describe();
    EXPECT_FALSE((*simulation)->plant().has_load());
    EXPECT_FALSE((*simulation)->find("load_factor")) << plant;
    for (const std::string& state : (*simulation)->state_names())
      EXPECT_NE((*simulation)->plant().find_state(state), nullptr) << plant << " " << state;
    const TimeSeries without_output{samples.time_s, {samples.channels[0]}, false};
    EXPECT_FALSE(PlantSimulation::create(nominal_asset(plant), without_output)) << plant;
    const TimeSeries without_input{samples.time_s, {samples.channels[1]}, false};
    const auto failed = PlantSimulation::create(nominal_asset(plant), without_input);
    ASSERT_FALSE(failed) << plant;
    EXPECT_NE(failed.error().describe().find(input), std::string::npos) << failed.error().describe();
  }
}

}  // namespace
}  // namespace sealwatch

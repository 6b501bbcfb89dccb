// Integration error on a standard partial stroke test against SUNDIALS CVODE at tight tolerances, the input held
// identical.
//
// The error counts as small when it cannot be told from noise even after averaging over all N samples:
//   N (rms error / sigma)^2 < 1 for every channel.
// In CVODE the sensors' filters are states of the differential equations, so that the error of filtering samples counts
// too.
#include <cvode/cvode.h>
#include <gtest/gtest.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include "sealwatch/model/eha.hpp"
#include "sealwatch/model/simulation.hpp"
#include "tests/unit/model/standard_pst.hpp"

namespace sealwatch {
namespace {

constexpr int kSensors = 7;
constexpr int kEquations = Eha::kStates + kSensors;

/// The plant and its seven sensors as one system for CVODE.
struct Oracle {
  EhaParameters<double> parameters{};
  const TimeSeries* samples = nullptr;
  std::array<double, kSensors> time_constants{};

  [[nodiscard]] double voltage(double t) const {
    const auto& time = samples->time_s;
    const auto& u = samples->find("motor_voltage")->values;
    const double position = std::max(0.0, t - time.front()) / (time[1] - time[0]);
    const auto row = std::min(static_cast<std::size_t>(position), time.size() - 2);
    const double share = std::min(1.0, position - static_cast<double>(row));
    return u[row] + share * (u[row + 1] - u[row]);
  }
  [[nodiscard]] std::array<double, kSensors> signals(const std::array<double, Eha::kStates>& y) const {
    return {y[Eha::kI],
            y[Eha::kOmega],
            y[Eha::kPA],
            y[Eha::kPB],
            Eha::valve_flow(y[Eha::kP1], y[Eha::kPA], y[Eha::kP2], parameters),
            y[Eha::kX],
            y[Eha::kV]};
  }
};

int right_hand_side(realtype t, N_Vector y, N_Vector ydot, void* data) {
  const Oracle& oracle = *static_cast<const Oracle*>(data);
  std::array<double, Eha::kStates> state;
  std::copy(N_VGetArrayPointer(y), N_VGetArrayPointer(y) + Eha::kStates, state.begin());
  const auto rate = Eha::derivatives(state, {oracle.voltage(t)}, oracle.parameters);
  std::copy(rate.begin(), rate.end(), N_VGetArrayPointer(ydot));
  const auto signals = oracle.signals(state);
  for (int k = 0; k < kSensors; ++k) {
    const double tau = oracle.time_constants[k] > 0.0 ? oracle.time_constants[k] : 1.0;
    NV_Ith_S(ydot, Eha::kStates + k) = (signals[k] - NV_Ith_S(y, Eha::kStates + k)) / tau;
  }
  return 0;
}

/// State and channels at the given times (starting with the first) from a state.
std::vector<std::array<double, kEquations>> solve_with_cvode(Oracle& oracle,
                                                             const std::array<double, Eha::kStates>& rest,
                                                             const std::vector<double>& times) {
  constexpr double kRelative = 1e-9;
  SUNContext context = nullptr;
  SUNContext_Create(nullptr, &context);
  N_Vector y = N_VNew_Serial(kEquations, context), tolerance = N_VNew_Serial(kEquations, context);
  const std::array<double, kEquations> allowed = {1e-8,  1e-8, 1e-7, 1e-2, 1e-2, 1e-2,  1e-2,  1e-12,
                                                  1e-13, 1e-8, 1e-7, 1e-2, 1e-2, 1e-14, 1e-13, 1e-12};
  std::copy(allowed.begin(), allowed.end(), N_VGetArrayPointer(tolerance));
  std::copy(rest.begin(), rest.end(), N_VGetArrayPointer(y));
  const auto start = oracle.signals(rest);
  std::copy(start.begin(), start.end(), N_VGetArrayPointer(y) + Eha::kStates);
  SUNMatrix matrix = SUNDenseMatrix(kEquations, kEquations, context);
  SUNLinearSolver solver = SUNLinSol_Dense(y, matrix, context);
  void* cvode = CVodeCreate(CV_BDF, context);
  CVodeInit(cvode, right_hand_side, times.front(), y);
  CVodeSVtolerances(cvode, kRelative, tolerance);
  CVodeSetUserData(cvode, &oracle);
  CVodeSetLinearSolver(cvode, solver, matrix);
  CVodeSetMaxNumSteps(cvode, 100000);
  CVodeSetMaxStep(cvode, 0.02);
  std::vector<std::array<double, kEquations>> rows;
  for (const double time : times) {
    double reached = 0.0;
    if (time > times.front()) {
      EXPECT_GE(CVode(cvode, time, y, &reached, CV_NORMAL), 0);
    }
    std::array<double, kEquations> row;
    std::copy(N_VGetArrayPointer(y), N_VGetArrayPointer(y) + kEquations, row.begin());
    std::array<double, Eha::kStates> state;
    std::copy(row.begin(), row.begin() + Eha::kStates, state.begin());
    const auto signals = oracle.signals(state);
    for (int k = 0; k < kSensors; ++k)
      if (oracle.time_constants[k] == 0.0) row[Eha::kStates + k] = signals[k];
    rows.push_back(row);
  }
  CVodeFree(&cvode);
  SUNLinSolFree(solver);
  SUNMatDestroy(matrix);
  N_VDestroy(y);
  N_VDestroy(tolerance);
  SUNContext_Free(&context);
  return rows;
}

void compare(double load_factor, double rate_Hz) {
  const AssetConfig asset = nominal_asset("eha");
  const TimeSeries pst = standard_pst(asset, rate_Hz);
  const auto simulation = PlantSimulation::create(asset, pst);
  ASSERT_TRUE(simulation);
  ModelValues values = (*simulation)->start();
  values.load_factor = load_factor;
  // All states given, so that both start from the same point.
  std::vector<FreeQuantity> all;
  for (const std::string& state : (*simulation)->state_names())
    all.push_back((*simulation)->find("initial:" + state).value());
  Oracle oracle;
  std::size_t index = 0;
  oracle.parameters.visit(
      [&](std::string_view, double& value) {
        value = index < values.parameters.size() ? values.parameters[index] : load_factor;
        ++index;
      },
      oracle.parameters);
  oracle.samples = &pst;
  for (int k = 0; k < kSensors; ++k)
    oracle.time_constants[k] = asset.sensors.at((*simulation)->channels()[k]).time_constant_s;
  // CVODE settles the circuit for half a second before the test.
  const auto settled =
      solve_with_cvode(oracle, {4.0, 2.0, 15.0, 1.12e7, 9.9e5, 1.12e7, 1.0e6, 0.0, 0.060}, {-0.5, 0.0});
  std::array<double, Eha::kStates> rest;
  std::copy(settled.back().begin(), settled.back().begin() + Eha::kStates, rest.begin());
  const auto exact = solve_with_cvode(oracle, rest, pst.time_s);
  values.initial_state.assign(rest.begin(), rest.end());
  const auto outputs = (*simulation)->run(values, all);
  ASSERT_TRUE(outputs) << outputs.error().describe();
  for (int k = 0; k < kSensors; ++k) {
    const std::string& channel = (*simulation)->channels()[k];
    const double sigma = asset.sensors.at(channel).noise_std;
    double sum = 0.0, largest = 0.0;
    std::size_t where = 0;
    for (std::size_t row = 0; row < exact.size(); ++row) {
      const double error = (outputs->values(static_cast<Eigen::Index>(row), k) - exact[row][Eha::kStates + k]) / sigma;
      sum += error * error;
      if (std::abs(error) > largest) largest = std::abs(error), where = row;
    }
    std::printf("load %+.1f, %.0f Hz  %-14s N (rms error / sigma)^2 = %.3g, largest error %.2g sigma at %.3f s\n",
                load_factor, rate_Hz, channel.c_str(), sum, largest, pst.time_s[where]);
    EXPECT_LT(sum, 1.0) << channel;
  }
}

TEST(IntegrationAccuracy, IsBelowWhatTheSensorsCanShowOnAStandardPst) { compare(0.0, 200.0); }
TEST(IntegrationAccuracy, IsBelowWhatTheSensorsCanShowUnderHighLoad) { compare(0.2, 200.0); }
TEST(IntegrationAccuracy, IsBelowWhatTheSensorsCanShowAtAHundredHertz) { compare(0.1, 100.0); }

}  // namespace
}  // namespace sealwatch

#include "tests/perf/mismatch/cvodes_sensitivities.hpp"

#include <cvodes/cvodes.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <algorithm>

#include "sealwatch/model/eha.hpp"

namespace sealwatch::perf {
namespace {

constexpr int kSites = static_cast<int>(Eha::kSites.size());
using Direction = Dual<Eha::kStates + kSites>;  ///< by state, then by site
constexpr std::array<double, Eha::kStates> kUsual = {10.0, 5.0, 50.0, 1e6, 1e6, 1e6, 1e6, 1e-2, 0.1};

struct Problem {
  EhaParameters<double> parameters{};
  const TimeSeries* recorded = nullptr;
  InjectedColumns* injected = nullptr;
  std::vector<double> weights;

  [[nodiscard]] Eha::Input input(double t) const {
    const auto& time = recorded->time_s;
    const auto& u = recorded->find("motor_voltage")->values;
    const double position = std::max(0.0, t - time.front()) / (time[1] - time[0]);
    const auto row = std::min(static_cast<std::size_t>(position), time.size() - 2);
    const double slope = u[row + 1] - u[row];
    return {.voltage_V = u[row] + std::min(1.0, position - static_cast<double>(row)) * slope,
            .voltage_rate_V_s = slope / (time[1] - time[0])};
  }

  [[nodiscard]] std::array<Direction, Eha::kStates> linearised(double t, const double* y) const {
    std::array<Direction, Eha::kStates> state;
    for (int k = 0; k < Eha::kStates; ++k) state[k] = Direction::variable(y[k], k);
    std::array<Direction, kSites> extra;
    for (int k = 0; k < kSites; ++k) extra[k] = Direction::variable(0.0, Eha::kStates + k);
    return Eha::derivatives(state, input(t), parameters, extra);
  }
};

int right_hand_side(realtype t, N_Vector y, N_Vector rate, void* data) {
  const Problem& problem = *static_cast<const Problem*>(data);
  std::array<double, Eha::kStates> state;
  std::copy_n(N_VGetArrayPointer(y), Eha::kStates, state.begin());
  const auto result = Eha::derivatives(state, problem.input(t), problem.parameters);
  std::ranges::copy(result, N_VGetArrayPointer(rate));
  return 0;
}

int jacobian(realtype t, N_Vector y, N_Vector, SUNMatrix matrix, void* data, N_Vector, N_Vector, N_Vector) {
  const auto rates = static_cast<const Problem*>(data)->linearised(t, N_VGetArrayPointer(y));
  for (int row = 0; row < Eha::kStates; ++row)
    for (int column = 0; column < Eha::kStates; ++column)
      SM_ELEMENT_D(matrix, row, column) = rates[row].derivative[column];
  return 0;
}

// dS/dt = J S + df/dextra w
int sensitivity_rates(int columns, realtype t, N_Vector y, N_Vector, N_Vector* s, N_Vector* rate, void* data, N_Vector,
                      N_Vector) {
  Problem& problem = *static_cast<Problem*>(data);
  const double* at = N_VGetArrayPointer(y);
  const auto rates = problem.linearised(t, at);
  std::array<double, Eha::kStates> state;
  std::copy_n(at, Eha::kStates, state.begin());
  const std::array<double, kSites> none{};
  std::array<std::array<double, kSiteSignals>, kSites> signals;
  for (std::size_t site = 0; site < kSites; ++site)
    signals[site] = Eha::signals<double>(site, state, problem.input(t), problem.parameters, none);
  problem.injected->weigh(t, signals, problem.weights);
  for (int c = 0; c < columns; ++c)
    for (int row = 0; row < Eha::kStates; ++row) {
      double sum = 0.0;
      for (int k = 0; k < Eha::kStates; ++k) sum += rates[row].derivative[k] * NV_Ith_S(s[c], k);
      NV_Ith_S(rate[c], row) = sum;
    }
  const auto entries = problem.injected->entries();
  for (std::size_t e = 0; e < entries.size(); ++e)
    for (int row = 0; row < Eha::kStates; ++row)
      NV_Ith_S(rate[entries[e].column], row) +=
          rates[row].derivative[Eha::kStates + static_cast<int>(entries[e].site)] * problem.weights[e];
  return 0;
}

}  // namespace

CvodesRun sensitivities_by_cvodes(const ModelValues& values, const TimeSeries& recorded, double relative_tolerance,
                                  InjectedColumns& injected) {
  Problem problem{.parameters = {}, .recorded = &recorded, .injected = &injected, .weights = {}};
  problem.weights.resize(injected.entries().size());
  std::size_t index = 0;
  problem.parameters.visit(
      [&](std::string_view, double& value) {
        value = index < values.parameters.size() ? values.parameters[index] : values.load_factor;
        ++index;
      },
      problem.parameters);
  const int columns = static_cast<int>(injected.columns());
  SUNContext context = nullptr;
  SUNContext_Create(nullptr, &context);
  N_Vector y = N_VNew_Serial(Eha::kStates, context), tolerance = N_VNew_Serial(Eha::kStates, context);
  std::ranges::copy(values.initial_state, N_VGetArrayPointer(y));
  for (int k = 0; k < Eha::kStates; ++k) NV_Ith_S(tolerance, k) = relative_tolerance * kUsual[k];
  SUNMatrix matrix = SUNDenseMatrix(Eha::kStates, Eha::kStates, context);
  SUNLinearSolver solver = SUNLinSol_Dense(y, matrix, context);
  void* cvodes = CVodeCreate(CV_BDF, context);
  CVodeInit(cvodes, right_hand_side, recorded.time_s.front(), y);
  CVodeSVtolerances(cvodes, relative_tolerance, tolerance);
  CVodeSetUserData(cvodes, &problem);
  CVodeSetLinearSolver(cvodes, solver, matrix);
  CVodeSetJacFn(cvodes, jacobian);
  CVodeSetMaxNumSteps(cvodes, 200000);
  CVodeSetMaxStep(cvodes, kLongestStep_s);
  N_Vector* s = N_VCloneVectorArray(columns, y);
  for (int c = 0; c < columns; ++c) N_VConst(0.0, s[c]);
  CVodeSensInit(cvodes, columns, CV_STAGGERED, sensitivity_rates, s);
  CVodeSensEEtolerances(cvodes);
  std::vector<double> ones(static_cast<std::size_t>(columns), 1.0);
  CVodeSetSensParams(cvodes, nullptr, ones.data(), nullptr);
  CVodeSetSensErrCon(cvodes, SUNFALSE);  // as in the pass: the states alone choose the step
  CvodesRun run{.position = RowMatrix::Zero(static_cast<Eigen::Index>(recorded.time_s.size()), columns)};
  for (std::size_t row = 1; row < recorded.time_s.size(); ++row) {
    double reached = 0.0;
    if (CVode(cvodes, recorded.time_s[row], y, &reached, CV_NORMAL) < 0) break;
    CVodeGetSens(cvodes, &reached, s);
    for (int c = 0; c < columns; ++c) run.position(static_cast<Eigen::Index>(row), c) = NV_Ith_S(s[c], Eha::kX);
  }
  CVodeGetNumSteps(cvodes, &run.steps);
  N_VDestroyVectorArray(s, columns);
  CVodeFree(&cvodes);
  SUNLinSolFree(solver);
  SUNMatDestroy(matrix);
  N_VDestroy(y);
  N_VDestroy(tolerance);
  SUNContext_Free(&context);
  return run;
}

}  // namespace sealwatch::perf

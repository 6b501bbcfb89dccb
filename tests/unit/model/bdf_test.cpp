// The integrator on problems with known solutions: order of convergence, stiffness, sensitivities, interpolation.
#include "sealwatch/ode/bdf.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "sealwatch/model/dual.hpp"

namespace sealwatch {
namespace {

/// A system from one function f(t, y, p) on dual numbers: N states, and one parameter.
template <int N, class Function>
struct DualSystem final : OdeSystem<N> {
  using Matrix = typename OdeSystem<N>::Matrix;
  DualSystem(Function rates, double value) : function(rates), parameter(value) {}
  Function function;
  double parameter;

  void evaluate(double t, const double* y, double* f) const override {
    Matrix unused;
    linearise(t, y, f, unused);
  }
  void linearise(double t, const double* y, double* f, Matrix& jacobian) const override {
    std::array<Dual<N>, N> state;
    for (int k = 0; k < N; ++k) state[k] = Dual<N>::variable(y[k], k);
    const auto result = function(t, state, Dual<N>(parameter));
    for (int k = 0; k < N; ++k) f[k] = result[k].value, jacobian[k] = result[k].derivative;
  }
  void add_parameter_derivatives(double t, const double* y, double factor, double* x,
                                 std::size_t stride) const override {
    if (stride == 1) return;  // states alone: there is no column for the parameter
    std::array<Dual<1>, N> state;
    for (int k = 0; k < N; ++k) state[k] = y[k];
    const auto result = function(t, state, Dual<1>::variable(parameter, 0));
    for (int k = 0; k < N; ++k) x[k * stride + 1] += factor * result[k].derivative[0];
  }
};

template <int N, class Function>
DualSystem<N, Function> make_system(Function function, double parameter = 0.0) {
  return {function, parameter};
}

template <int N>
std::vector<double> integrate(Bdf<N>& bdf, const std::array<double, static_cast<std::size_t>(N)>& start, double end) {
  std::vector<double> values(bdf.size(), 0.0);
  for (int k = 0; k < N; ++k) values[k * bdf.stride()] = start[k];
  EXPECT_TRUE(bdf.start(0.0, values.data()));
  while (bdf.time() < end)
    if (!bdf.step()) {
      ADD_FAILURE() << "stopped at " << bdf.time();
      break;
    }
  bdf.interpolate(end, values.data());
  return values;
}

// y' = -50 (y - cos t) - sin t, y = cos t: error falls with the number of steps to the power of the order.
TEST(Bdf, ConvergesWithTheOrderThatIsAllowed) {
  const auto f = [](double t, const auto& y, const auto&) {
    return std::array{-50.0 * (y[0] - std::cos(t)) - std::sin(t)};
  };
  const auto system = make_system<1>(f);
  for (int order = 1; order <= 5; ++order) {
    const auto run = [&](double tolerance) {
      Bdf<1> bdf(system, 0, {tolerance}, {.maximum_order = order});
      const double error = std::abs(integrate(bdf, {1.0}, 10.0)[0] - std::cos(10.0));
      return std::pair(static_cast<double>(bdf.statistics().steps), error);
    };
    // Errors at the single end point scatter: the slope over four decades of the tolerance evens that out.
    const auto [coarse_steps, coarse_error] = run(1e-4);
    const auto [fine_steps, fine_error] = run(1e-8);
    const double observed = std::log(coarse_error / fine_error) / std::log(fine_steps / coarse_steps);
    EXPECT_GT(observed, order - 0.6) << "order " << order;
  }
}

// Robertson's kinetics: reference values at t = 40 (E. Hairer, G. Wanner, Solving ODEs II, problem ROBER).
TEST(Bdf, SolvesRobertsonsProblem) {
  const auto f = [](double, const auto& y, const auto& k) {
    const auto a = k * y[0] - 1e4 * y[1] * y[2], b = 3e7 * y[1] * y[1];
    return std::array{-a, a - b, b};
  };
  const auto system = make_system<3>(f, 0.04);
  Bdf<3> bdf(system, 0, {1e-8, 1e-13, 1e-8});
  const auto y = integrate(bdf, {1.0, 0.0, 0.0}, 40.0);
  EXPECT_NEAR(y[0], 0.7158270687193941, 1e-6);
  EXPECT_NEAR(y[1], 9.185534764557763e-06, 1e-11);
  EXPECT_NEAR(y[2], 0.2841637457458413, 1e-6);
  EXPECT_NEAR(y[0] + y[1] + y[2], 1.0, 1e-7) << "mass";
  EXPECT_LT(bdf.statistics().steps, 1000u);
}

// Van der Pol's equation with mu^-2 = 1e-6: reference values at t = 2 from the Bari test set for IVP solvers, problem
// VDPOL.
TEST(Bdf, SolvesVanDerPolsProblem) {
  const auto f = [](double, const auto& y, const auto&) {
    return std::array{y[1] + 0.0, ((1.0 - y[0] * y[0]) * y[1] - y[0]) / 1e-6};
  };
  const auto system = make_system<2>(f);
  Bdf<2> bdf(system, 0, {1e-9, 1e-8});
  const auto y = integrate(bdf, {2.0, 0.0}, 2.0);
  EXPECT_NEAR(y[0], 1.706167732170469, 1e-5);
  EXPECT_NEAR(y[1], -0.8928097010248125, 1e-5);
}

// y' = -k y^2 (stiff partner z' = -1000 (z - y)): dy/dk is known, and the sensitivity follows with the states'
// accuracy.
TEST(Bdf, IntegratesSensitivities) {
  constexpr double k = 0.7, t = 3.0;
  const auto f = [](double, const auto& y, const auto& rate) {
    return std::array{-rate * y[0] * y[0], -1000.0 * (y[1] - y[0]) + 0.0 * rate};
  };
  const auto system = make_system<2>(f, k);
  Bdf<2> bdf(system, 1, {1e-9, 1e-9});
  const auto y = integrate(bdf, {1.0, 1.0}, t);
  EXPECT_NEAR(y[0], 1.0 / (1.0 + k * t), 1e-7);
  EXPECT_NEAR(y[1], -t / ((1.0 + k * t) * (1.0 + k * t)), 1e-6);
  // z follows y with a lag of y'/1000, the sensitivity likewise.
  EXPECT_NEAR(y[bdf.stride() + 1], y[1], 1e-3);
}

TEST(Bdf, InterpolatesBetweenStepsAsAccuratelyAsItSteps) {
  const auto f = [](double t, const auto& y, const auto&) {
    return std::array{-50.0 * (y[0] - std::cos(t)) - std::sin(t)};
  };
  const auto system = make_system<1>(f);
  Bdf<1> bdf(system, 0, {1e-9});
  std::vector<double> value(bdf.size(), 1.0);
  double largest = 0.0;
  ASSERT_TRUE(bdf.start(0.0, value.data()));
  for (double t = 0.01; t < 10.0; t += 0.01) {
    while (bdf.time() < t) ASSERT_TRUE(bdf.step());
    bdf.interpolate(t, value.data());
    largest = std::max(largest, std::abs(value[0] - std::cos(t)));
  }
  EXPECT_LT(largest, 2e-8);
}

TEST(Bdf, FailsInsteadOfLoopingWhereTheSolutionEnds) {
  const auto f = [](double, const auto& y, const auto&) { return std::array{y[0] * y[0]}; };  // blows up at t = 1
  const auto system = make_system<1>(f);
  Bdf<1> bdf(system, 0, {1e-6}, {.maximum_steps = 5000});
  std::vector<double> value(bdf.size(), 1.0);
  ASSERT_TRUE(bdf.start(0.0, value.data()));
  while (bdf.time() < 2.0 && bdf.step()) {
  }
  EXPECT_LT(bdf.time(), 1.01);
}

TEST(LuFactorisation, SolvesWithPivotingAndReportsSingularity) {
  LuFactorisation<3> lu;
  const LuFactorisation<3>::Matrix matrix = {{{0.0, 2.0, 1.0}, {1.0, 1.0, 0.0}, {4.0, 0.0, -1.0}}};
  ASSERT_TRUE(lu.factorise(matrix));
  // Two right-hand sides, M times (1, 2, 3) and M times (-1, 0, 5).
  std::array<double, 6> x = {7.0, 5.0, 3.0, -1.0, 1.0, -9.0};
  lu.solve(x.data(), 2, 2);
  const std::array<double, 6> expected = {1.0, -1.0, 2.0, 0.0, 3.0, 5.0};
  for (std::size_t k = 0; k < x.size(); ++k) EXPECT_NEAR(x[k], expected[k], 1e-14);
  EXPECT_FALSE(lu.factorise({{{1.0, 2.0, 3.0}, {2.0, 4.0, 6.0}, {0.0, 0.0, 1.0}}}));
}

/// Two states of at most five.
struct FewerStates final : OdeSystem<at_most(5)> {
  [[nodiscard]] int states() const override { return 2; }
  void evaluate(double, const double* y, double* f) const override { f[0] = -0.7 * y[0] * y[0], f[1] = y[0] - y[1]; }
  void linearise(double t, const double* y, double* f, Matrix& jacobian) const override {
    evaluate(t, y, f);
    jacobian[0][0] = -1.4 * y[0], jacobian[0][1] = 0.0, jacobian[1][0] = 1.0, jacobian[1][1] = -1.0;
  }
  void add_parameter_derivatives(double, const double*, double, double*, std::size_t) const override {}
};

TEST(Bdf, TakesFewerStatesThanThereMayBe) {
  const auto f = [](double, const auto& y, const auto&) { return std::array{-0.7 * y[0] * y[0], y[0] - y[1]}; };
  const auto system = make_system<2>(f);
  const FewerStates fewer;
  Bdf<2> of_two(system, 0, {1e-9, 1e-9});
  Bdf<at_most(5)> of_five(fewer, 0, {1e-9, 1e-9});
  EXPECT_EQ(of_five.size(), 2U);
  const std::array<double, 2> start = {1.0, 0.5};
  ASSERT_TRUE(of_two.start(0.0, start.data()));
  ASSERT_TRUE(of_five.start(0.0, start.data()));
  while (of_two.time() < 1.0) ASSERT_TRUE(of_two.step() && of_five.step());
  EXPECT_EQ(of_five.time(), of_two.time());
  EXPECT_NEAR(of_five.values()[0], of_two.values()[0], 1e-12);
  EXPECT_NEAR(of_five.values()[1], of_two.values()[1], 1e-12);
}

// As many columns as vectors hold, and more, and between: each as if it were alone.
TEST(LuFactorisation, SolvesManyColumnsAsOneByOne) {
  constexpr int kSize = 5;
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  LuFactorisation<kSize> lu;
  LuFactorisation<kSize>::Matrix matrix;
  for (auto& row : matrix)
    for (double& value : row) value = normal(random);
  matrix[3][1] = matrix[4][0] = 0.0;
  ASSERT_TRUE(lu.factorise(matrix));
  for (const std::size_t columns : {1, 3, 4, 16, 23}) {
    const std::size_t stride = columns + 2;
    std::vector<double> x(kSize * stride);
    for (double& value : x) value = normal(random);
    const std::vector<double> right = x;
    lu.solve(x.data(), columns, stride);
    for (std::size_t column = 0; column < stride; ++column) {
      std::array<double, kSize> alone;
      for (std::size_t row = 0; row < kSize; ++row) alone[row] = right[row * stride + column];
      if (column < columns) lu.solve(alone.data());
      for (std::size_t row = 0; row < kSize; ++row) EXPECT_EQ(x[row * stride + column], alone[row]) << column;
    }
  }
}

}  // namespace
}  // namespace sealwatch

// The bench's integrator on problems with known solutions.
#include "services/virtual_bench/rosenbrock.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace sealwatch::bench {
namespace {

/// dy/dt = -rate (y - sin t) + cos t, y = sin t: stiff, driven by time.
struct Outcome {
  std::size_t steps = 0;
  double end_error = 0.0;
  double largest_sample_error = 0.0;
};

Outcome follow_sine(double rate, double tolerance) {
  const Rates f = [rate](double t, const double* y, double* dy) { dy[0] = -rate * (y[0] - std::sin(t)) + std::cos(t); };
  std::vector<double> state = {0.0}, times;
  for (int k = 1; k <= 1000; ++k) times.push_back(0.01 * k);
  Outcome out;
  std::size_t taken = 0;
  const TakeSample take = [&](double time, const std::vector<double>& y) {
    ++taken;
    out.largest_sample_error = std::max(out.largest_sample_error, std::abs(y[0] - std::sin(time)));
  };
  StepControl control;
  control.tolerance = tolerance;
  out.steps = integrate_rosenbrock(f, state, 0.0, 10.0, times, take, control);
  out.end_error = std::abs(state[0] - std::sin(10.0));
  EXPECT_EQ(taken, times.size());
  return out;
}

TEST(Rosenbrock, FollowsADrivenEquation) {
  for (const double rate : {1.0, 1e3}) {
    const Outcome outcome = follow_sine(rate, 1e-7);
    EXPECT_LT(outcome.end_error, 1e-5) << rate;             // some hundred steps of 1e-7 each
    EXPECT_LT(outcome.largest_sample_error, 1e-4) << rate;  // dense output is of lower order
    EXPECT_LT(outcome.steps, 2000U) << rate;
  }
}

TEST(Rosenbrock, AStraightReferenceCostsNoStepsHoweverStiff) {
  // y' = -rate (y - t), y = t - 1 / rate: what the bench's ramps are to its fast states.
  for (const double rate : {1.0, 1e3, 1e6}) {
    const Rates f = [rate](double t, const double* y, double* dy) { dy[0] = -rate * (y[0] - t); };
    std::vector<double> state = {-1.0 / rate};
    EXPECT_LT(integrate_rosenbrock(f, state, 0.0, 10.0, {}, {}, {}), 50U) << rate;
    EXPECT_NEAR(state[0], 10.0 - 1.0 / rate, 1e-8) << rate;
  }
}

TEST(Rosenbrock, ErrorFallsWithTheTolerance) {
  const double coarse = follow_sine(10.0, 1e-4).end_error;
  const double fine = follow_sine(10.0, 1e-8).end_error;
  EXPECT_LT(fine, 0.01 * coarse);
}

TEST(Rosenbrock, TakesNoSampleOutsideTheInterval) {
  const Rates f = [](double, const double*, double* dy) { dy[0] = 1.0; };
  std::vector<double> state = {0.0}, taken;
  const TakeSample take = [&](double time, const std::vector<double>& y) {
    taken.push_back(time);
    EXPECT_NEAR(y[0], time - 1.0, 1e-12);
  };
  integrate_rosenbrock(f, state, 1.0, 2.0, {0.5, 1.0, 1.5, 2.0, 2.5}, take, {});
  EXPECT_EQ(taken, (std::vector<double>{1.5, 2.0}));
  EXPECT_NEAR(state[0], 1.0, 1e-12);
}

TEST(Rosenbrock, GivesUpAfterTheMostSteps) {
  const Rates f = [](double t, const double* y, double* dy) { dy[0] = -1e3 * (y[0] - std::sin(100.0 * t)); };
  std::vector<double> state = {0.0};
  StepControl control;
  control.most_steps = 10;
  EXPECT_THROW(integrate_rosenbrock(f, state, 0.0, 10.0, {}, {}, control), std::runtime_error);
}

}  // namespace
}  // namespace sealwatch::bench

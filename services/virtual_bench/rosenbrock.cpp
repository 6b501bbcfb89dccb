#include "services/virtual_bench/rosenbrock.hpp"

#include <algorithm>
#include <boost/numeric/odeint/stepper/rosenbrock4.hpp>
#include <boost/numeric/odeint/stepper/rosenbrock4_controller.hpp>
#include <boost/numeric/odeint/stepper/rosenbrock4_dense_output.hpp>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace sealwatch::bench {
namespace {

namespace odeint = boost::numeric::odeint;
using Stepper = odeint::rosenbrock4<double>;
using Vector = Stepper::state_type;
using Matrix = Stepper::matrix_type;

/// f with time as one more, last state: dt/dt = 1. Odeint's own treatment of df/dt is wrong in Boost 1.74 (d4 of its
/// coefficients lacks a minus sign, so that f(t) costs thousands of steps); without df/dt it is not used.
class Autonomous {
 public:
  Autonomous(const Rates& f, std::size_t states) : f_(f), base_(states), moved_(states), point_(states + 1) {}

  void rates(const Vector& state, Vector& out) const {
    const std::size_t n = base_.size();
    f_(state[n], &state[0], &out[0]);
    out[n] = 1.0;
  }

  void jacobian(const Vector& state, Matrix& out, Vector& by_time) {
    constexpr double kIncrement = 1e-7;  // about the root of a double's rounding, for states of about 1
    const std::size_t n = base_.size();
    std::copy(state.begin(), state.end(), point_.begin());
    f_(point_[n], point_.data(), base_.data());
    for (std::size_t column = 0; column <= n; ++column) {
      const double increment = kIncrement * std::max(1.0, std::abs(state[column]));
      point_[column] = state[column] + increment;
      f_(point_[n], point_.data(), moved_.data());
      point_[column] = state[column];
      for (std::size_t row = 0; row < n; ++row) out(row, column) = (moved_[row] - base_[row]) / increment;
      out(n, column) = 0.0;
    }
    std::fill(by_time.begin(), by_time.end(), 0.0);
  }

 private:
  const Rates& f_;
  std::vector<double> base_, moved_, point_;
};

}  // namespace

std::size_t integrate_rosenbrock(const Rates& f, std::vector<double>& state, double start, double end,
                                 const std::vector<double>& times, const TakeSample& take, const StepControl& control) {
  if (!(end > start)) return 0;
  Autonomous equations(f, state.size());
  const auto system = std::make_pair(
      [&equations](const Vector& y, Vector& rates, double) { equations.rates(y, rates); },
      [&equations](const Vector& y, Matrix& out, double, Vector& by_time) { equations.jacobian(y, out, by_time); });
  using Controlled = odeint::rosenbrock4_controller<Stepper>;
  odeint::rosenbrock4_dense_output<Controlled> stepper(
      Controlled(control.tolerance, control.tolerance, control.largest_step));
  Vector at(state.size() + 1);
  std::copy(state.begin(), state.end(), at.begin());
  at[state.size()] = start;
  stepper.initialize(at, start, control.first_step);
  const auto interpolate = [&](double time) {
    stepper.calc_state(time, at);
    std::copy(at.begin(), at.end() - 1, state.begin());
  };
  auto next = std::upper_bound(times.begin(), times.end(), start);
  std::size_t steps = 0;
  for (double now = start; now < end; ++steps) {
    if (steps == control.most_steps) throw std::runtime_error("more than " + std::to_string(steps) + " steps");
    now = stepper.do_step(system).second;
    for (; next != times.end() && *next <= std::min(now, end); ++next) {
      interpolate(*next);
      take(*next, state);
    }
  }
  interpolate(end);
  return steps;
}

}  // namespace sealwatch::bench

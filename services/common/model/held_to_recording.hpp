// A simulation that is held to what was recorded: a Luenberger observer in place of a free run. Where a free run from
// wrong parameters stands still or runs away, it stays near the recorded course, so that what its equations lack shows
// where and when it is lacking, and nearly in proportion.
//
//   dy_i/dt = f_i + g_1 (r_i(t) - y_i)     y_i a state that is measured, r_i its record, smoothed over tau / 5 at most
//   dy_j/dt = f_j + g_2 (r_i(t) - y_i)     y_j the rate of y_i (f_i = c y_j, as speed to position) that is not measured
//   g_1 = 1 / tau, g_2 = 0; with a rate g_1 = 2 / tau, g_2 = 1 / (c tau^2): critically damped, both within tau
//
// D. G. Luenberger, IEEE Trans. Automatic Control 16 (1971) 596. As a start of a fit: H. D. I. Abarbanel, D. R. Creveling,
// R. Farsian, M. Kostuk, SIAM J. Applied Dynamical Systems 8 (2009) 1341.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "sealwatch/ode/bdf.hpp"
#include "services/common/model/recorded_course.hpp"

namespace sealwatch {

/// The recorded course of the states that are measured.
class MeasuredStates {
 public:
  struct State {
    int state = 0;
    RecordedCourse recorded;
    int rate = -1;       ///< the state that is its rate and not measured; -1: none
    double slope = 1.0;  ///< f_i / y_j: of a gear, or of another unit
  };

  /// Beside what the equations lack within tau, the noise of single samples says nothing, and costs steps.
  static constexpr double kSmoothed = 0.2;  // of tau

  /// `begin_s`: of the recording; `time_constant_s`: tau.
  MeasuredStates(double begin_s, std::vector<State> states, double time_constant_s)
      : begin_s_(begin_s), states_(std::move(states)), tau_s_(time_constant_s) {}

  /// Asks the equations which states are the rates of measured ones: of these alone, in proportion, both at a state and
  /// where every state is larger by its `size`. (Of a gear whose ratio is free, sensitivities lack what that does to g_2.)
  template <int N>
  void find_rates(const OdeSystem<N>& system, const std::vector<double>& at, const std::vector<double>& size);

  /// f += g (r - y)
  void add_to(double t, const double* y, double* f) const {
    for (const State& one : states_) {
      const double difference = one.recorded.at(t) - y[one.state];
      f[one.state] += gain(one) * difference;
      if (one.rate >= 0) f[one.rate] += gain_of_rate(one) * difference;
    }
  }
  template <class Matrix>
  void add_to(Matrix& jacobian) const {
    for (const State& one : states_) {
      jacobian[one.state][one.state] -= gain(one);
      if (one.rate >= 0) jacobian[one.rate][one.state] -= gain_of_rate(one);
    }
  }

 private:
  [[nodiscard]] double gain(const State& one) const { return (one.rate >= 0 ? 2.0 : 1.0) / tau_s_; }
  [[nodiscard]] double gain_of_rate(const State& one) const { return 1.0 / (tau_s_ * tau_s_ * one.slope); }

  double begin_s_;
  std::vector<State> states_;
  double tau_s_;
};

template <int N>
void MeasuredStates::find_rates(const OdeSystem<N>& system, const std::vector<double>& at,
                                const std::vector<double>& size) {
  const int count = state_count(system);
  auto f = SquareSystem<N>::vector(count);
  auto jacobian = SquareSystem<N>::matrix(count);
  constexpr double kAlmost = 1e-6;  // of derivatives that are differences
  // The only state on which f of a state depends, in proportion; -1: there is none.
  const auto only_rate = [&](State& one, const std::vector<double>& y) {
    int rate = -1;
    for (int k = 0; k < count; ++k) {
      const double slope = jacobian[one.state][k], share = slope * y[static_cast<std::size_t>(k)];
      if (slope == 0.0) continue;
      if (rate >= 0 || std::abs(f[one.state] - share) > kAlmost * std::abs(share)) return -1;
      rate = k;
      one.slope = slope;
    }
    return rate;
  };
  const auto is_measured = [&](int state) { return std::ranges::find(states_, state, &State::state) != states_.end(); };
  std::vector<double> larger = at;
  for (std::size_t k = 0; k < larger.size(); ++k) larger[k] += size[k];
  system.linearise(begin_s_, at.data(), f.data(), jacobian);
  for (State& one : states_) one.rate = only_rate(one, at);
  system.linearise(begin_s_, larger.data(), f.data(), jacobian);
  for (State& one : states_) {
    const double slope = one.slope;
    const bool same =
        one.rate >= 0 && only_rate(one, larger) == one.rate && std::abs(one.slope - slope) <= kAlmost * std::abs(slope);
    if (!same || is_measured(one.rate)) one.rate = -1;
  }
}

/// Equations with their measured states held.
template <int N>
class HeldToRecording final : public OdeSystem<N> {
 public:
  using typename OdeSystem<N>::Matrix;

  /// `at`: any state at which the equations have a value; `size`: of each state, usually.
  HeldToRecording(const OdeSystem<N>& system, MeasuredStates measured, const std::vector<double>& at,
                  const std::vector<double>& size)
      : system_(system), measured_(std::move(measured)) {
    measured_.find_rates(system, at, size);
  }

  [[nodiscard]] int states() const override { return state_count(system_); }
  void evaluate(double t, const double* y, double* f) const override {
    system_.evaluate(t, y, f);
    measured_.add_to(t, y, f);
  }
  void linearise(double t, const double* y, double* f, Matrix& jacobian) const override {
    system_.linearise(t, y, f, jacobian);
    measured_.add_to(t, y, f);
    measured_.add_to(jacobian);
  }
  void add_parameter_derivatives(double t, const double* y, double factor, double* x,
                                 std::size_t stride) const override {
    system_.add_parameter_derivatives(t, y, factor, x, stride);
  }

 private:
  const OdeSystem<N>& system_;
  MeasuredStates measured_;
};

}  // namespace sealwatch

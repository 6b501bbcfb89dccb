// The quasi-steady initial state: fast states for which dy/dt = 0 while the other states are held, and its
// sensitivities.
//
// The fast states relax from their guess in pseudo-time, integrated coarsely (so that they end in the rest that the
// real transient would reach), then Newton's iteration finishes:  -J_FF d = f_F. Sensitivities (F fast, H held):  -J_FF
// S_F = J_FH S_H + df_F/dp
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "sealwatch/ode/bdf.hpp"

namespace sealwatch {

template <int N>
class QuasiSteadyState {
 public:
  using System = OdeSystem<N>;
  using Sizes = SquareSystem<N>;
  using Vector = typename Sizes::Vector;
  using Matrix = typename Sizes::Matrix;

  /// `scale`: size of each state's allowed error.
  QuasiSteadyState(const System& system, double time, const std::vector<bool>& fast, std::vector<double> scale)
      : frozen_(system, time, fast), scale_(std::move(scale)) {}

  /// Moves the fast states to rest; false when they do not come to rest.
  [[nodiscard]] bool solve(std::vector<double>& state) { return relax(state) && finish(state); }

  /// Completes the fast rows of [y | S], whose held rows are seeded.
  [[nodiscard]] bool differentiate(const std::vector<double>& state, double* values, std::size_t stride) {
    Vector f = Sizes::vector(states());
    Matrix jacobian = Sizes::matrix(states());
    frozen_.system.linearise(frozen_.time, state.data(), f.data(), jacobian);
    std::vector<double> right(states() * stride, 0.0);
    frozen_.system.add_parameter_derivatives(frozen_.time, state.data(), 1.0, right.data(), stride);
    for (int row = 0; row < states(); ++row)
      for (std::size_t k = 1; k < stride; ++k) {
        if (!frozen_.fast[row]) right[row * stride + k] = values[row * stride + k];
        for (int held = 0; frozen_.fast[row] && held < states(); ++held)
          if (!frozen_.fast[held]) right[row * stride + k] += jacobian[row][held] * values[held * stride + k];
      }
    if (!lu_.factorise(reduced(jacobian), states())) return false;
    lu_.solve(right.data(), stride, stride);
    for (int row = 0; row < states(); ++row)
      for (std::size_t k = 1; k < stride; ++k) values[row * stride + k] = right[row * stride + k];
    return true;
  }

 private:
  /// The system at a fixed time whose held states do not move.
  struct Frozen final : System {
    Frozen(const System& of, double at, const std::vector<bool>& moving) : system(of), time(at), fast(moving) {}
    const System& system;
    double time;
    std::vector<bool> fast;
    [[nodiscard]] int states() const override { return state_count(system); }
    void evaluate(double, const double* y, double* f) const override {
      system.evaluate(time, y, f);
      for (int row = 0; row < states(); ++row)
        if (!fast[row]) f[row] = 0.0;
    }
    void linearise(double, const double* y, double* f, Matrix& jacobian) const override {
      system.linearise(time, y, f, jacobian);
      for (int row = 0; row < states(); ++row)
        if (!fast[row]) f[row] = 0.0, std::ranges::fill(jacobian[row], 0.0);
    }
    void add_parameter_derivatives(double, const double*, double, double*, std::size_t) const override {}
  };

  [[nodiscard]] int states() const { return state_count(frozen_.system); }

  [[nodiscard]] bool relax(std::vector<double>& state) const {
    constexpr double kPseudoTime_s = 100.0;  // many times the slowest leakage of a closed volume
    constexpr double kCoarser = 300.0;
    constexpr int kStableOrder = 2;  // A-stable: what swings and dies away slowly does not shorten the steps at rest
    std::vector<double> scale = scale_;
    for (double& value : scale) value *= kCoarser;
    Bdf<N> bdf(frozen_, 0, std::move(scale), {.maximum_steps = 5000, .maximum_order = kStableOrder});
    if (!bdf.start(0.0, state.data())) return false;
    while (bdf.time() < kPseudoTime_s)
      if (!bdf.step()) return false;
    for (int k = 0; k < states(); ++k) state[k] = bdf.values()[k];
    return true;
  }

  [[nodiscard]] bool finish(std::vector<double>& state) {
    constexpr int kIterations = 30;
    constexpr double kConverged = 1e-3;
    for (int iteration = 0; iteration < kIterations; ++iteration) {
      Vector change = Sizes::vector(states());
      Matrix jacobian = Sizes::matrix(states());
      frozen_.linearise(0.0, state.data(), change.data(), jacobian);
      if (!lu_.factorise(reduced(jacobian), states())) return false;
      lu_.solve(change.data());
      double largest = 0.0;
      for (int k = 0; k < states(); ++k) {
        state[k] += change[k];
        largest = std::max(largest, std::abs(change[k]) / scale_[k]);
      }
      if (largest < kConverged) return true;
    }
    return false;
  }

  // -J on the fast states, I on the held ones.
  [[nodiscard]] Matrix reduced(const Matrix& jacobian) const {
    Matrix matrix = Sizes::matrix(states());
    for (int row = 0; row < states(); ++row) {
      for (int column = 0; column < states(); ++column)
        if (frozen_.fast[row] && frozen_.fast[column]) matrix[row][column] = -jacobian[row][column];
      if (!frozen_.fast[row]) matrix[row][row] = 1.0;
    }
    return matrix;
  }

  Frozen frozen_;
  std::vector<double> scale_;
  LuFactorisation<N> lu_;
};

}  // namespace sealwatch

// The quasi-steady initial state: fast states for which dy/dt = 0 while the other states are held, and its
// sensitivities.
//
// Newton's iteration made robust by pseudo-time (implicit Euler whose step grows):
//   (I/h - J_FF) d = f_F;        sensitivities:  -J_FF S_F = J_FH S_H + df_F/dp      (F fast, H held)
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "sealwatch/ode/lu.hpp"

namespace sealwatch {

template <class System>
class QuasiSteadyState {
 public:
  static constexpr int kStates = System::kStates;
  using Mask = std::array<bool, kStates>;
  using Vector = std::array<double, kStates>;

  QuasiSteadyState(const System& system, const Mask& fast, const Vector& scale)
      : system_(system), fast_(fast), scale_(scale) {}

  /// Moves the fast states to rest; false when they do not come to rest.
  [[nodiscard]] bool solve(double time, Vector& state) {
    double pseudo_step = 1e-4;
    for (int iteration = 0; iteration < 300; ++iteration) {
      Vector change;
      if (!correction(time, state, 1.0 / pseudo_step, change)) return false;
      double largest = 0.0;
      for (int k = 0; k < kStates; ++k) {
        state[k] += change[k];
        largest = std::max(largest, std::abs(change[k]) / scale_[k]);
      }
      if (!std::isfinite(largest)) return false;
      if (pseudo_step > 1e9 && largest < 1e-3) return true;
      // Far from rest the step only grows slowly, so that the path stays that of the real transient.
      pseudo_step *= largest < 1e4 ? 4.0 : 1.3;
    }
    return false;
  }

  /// Completes the fast rows of [y | S], whose held rows are seeded.
  [[nodiscard]] bool differentiate(double time, const Vector& state, double* values, std::size_t stride) {
    Vector f;
    typename LuFactorisation<kStates>::Matrix jacobian;
    system_.linearise(time, state.data(), f.data(), jacobian);
    std::vector<double> right(kStates * stride, 0.0);
    system_.add_parameter_derivatives(time, state.data(), 1.0, right.data(), stride);
    for (int row = 0; row < kStates; ++row)
      for (std::size_t k = 1; k < stride; ++k) {
        double& entry = right[row * stride + k];
        if (!fast_[row])
          entry = values[row * stride + k];
        else
          for (int held = 0; held < kStates; ++held)
            if (!fast_[held]) entry += jacobian[row][held] * values[held * stride + k];
      }
    if (!lu_.factorise(reduced(jacobian, 0.0))) return false;
    lu_.solve(right.data(), static_cast<int>(stride), stride);
    for (int row = 0; row < kStates; ++row)
      for (std::size_t k = 1; k < stride; ++k) values[row * stride + k] = right[row * stride + k];
    return true;
  }

 private:
  // shift I - J on the fast states, I on the held ones.
  [[nodiscard]] typename LuFactorisation<kStates>::Matrix reduced(
      const typename LuFactorisation<kStates>::Matrix& jacobian, double shift) const {
    typename LuFactorisation<kStates>::Matrix matrix{};
    for (int row = 0; row < kStates; ++row) {
      for (int column = 0; column < kStates; ++column)
        if (fast_[row] && fast_[column]) matrix[row][column] = -jacobian[row][column];
      matrix[row][row] = fast_[row] ? matrix[row][row] + shift : 1.0;
    }
    return matrix;
  }

  [[nodiscard]] bool correction(double time, const Vector& state, double shift, Vector& change) {
    Vector f;
    typename LuFactorisation<kStates>::Matrix jacobian;
    system_.linearise(time, state.data(), f.data(), jacobian);
    if (!lu_.factorise(reduced(jacobian, shift))) return false;
    for (int k = 0; k < kStates; ++k) change[k] = fast_[k] ? f[k] : 0.0;
    lu_.solve(change.data(), 1, 1);
    return true;
  }

  const System& system_;
  Mask fast_;
  Vector scale_;
  LuFactorisation<kStates> lu_;
};

}  // namespace sealwatch

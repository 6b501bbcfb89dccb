// Variable-order (1 to 5), variable-step integration of stiff equations together with their forward sensitivities.
//
//   dy/dt = f(t, y, p),   dS/dt = J S + df/dp,   J = df/dy,   S = dy/dp
//
// Numerical differentiation formulas with backward differences and a step that is constant until it is changed
// (L. F. Shampine, M. W. Reichelt, The MATLAB ODE Suite, SIAM J. Sci. Comput. 18 (1997), section 2):
//
//   (1 - kappa_k) gamma_k (y_(n+1) - y^0_(n+1)) + sum_(m=1..k) gamma_m D_m - h f(t_(n+1), y_(n+1)) = 0
//
// with D_m the m-th backward difference, y^0 = sum_(m=0..k) D_m the prediction, gamma_m = sum_(j=1..m) 1/j. State and
// sensitivities are the columns of one matrix [y | S], n x (1 + K): one prediction, one set of differences, one
// interpolation. Each step: Jacobian at the prediction, one LU factorisation of I - c J (c = h / alpha_k), Newton's
// iteration for y, and then all columns of S at once, for which the equation is linear:  (I - c J) S = S^0 + c df/dp -
// psi_S. The local error is controlled for y; S follows with the same steps.
//
// Equations and their linear algebra are templates of the number of states alone, the rest is compiled once: calls of the
// equations are virtual, and cost nothing beside what they compute.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "sealwatch/ode/backward_differences.hpp"
#include "sealwatch/ode/lu.hpp"

namespace sealwatch {

/// Equations of N states; N may be kDynamicSize or at_most(n).
template <int N>
class OdeSystem {
 public:
  static constexpr int kStates = N;
  using Matrix = typename SquareSystem<N>::Matrix;

  virtual ~OdeSystem() = default;
  /// To be overridden where N does not say it.
  [[nodiscard]] virtual int states() const { return N; }
  /// f(t, y)
  virtual void evaluate(double t, const double* y, double* f) const = 0;
  /// f and J
  virtual void linearise(double t, const double* y, double* f, Matrix& jacobian) const = 0;
  /// X(:, 1 + k) += factor df/dp_k
  virtual void add_parameter_derivatives(double t, const double* y, double factor, double* x,
                                         std::size_t stride) const = 0;
};

/// Known to the compiler where N says it.
template <int N>
[[nodiscard]] int state_count(const OdeSystem<N>& system) {
  if constexpr (N < 0)
    return system.states();
  else
    return N;
}

template <int N>
class Bdf final : public BackwardDifferences {
 public:
  using System = OdeSystem<N>;
  using Sizes = SquareSystem<N>;
  using Matrix = typename Sizes::Matrix;
  using Vector = typename Sizes::Vector;

  Bdf(const System& system, int parameters, std::vector<double> scale, BdfOptions options = {})
      : BackwardDifferences(state_count(system), parameters, std::move(scale), options), system_(system) {
    for (Vector* vector : {&state_, &correction_, &rate_, &change_}) *vector = Sizes::vector(rows());
    matrix_ = Sizes::matrix(rows());
  }

  [[nodiscard]] bool start(double time, const double* values) override;

 private:
  [[nodiscard]] int rows() const {
    if constexpr (N < 0)
      return states();
    else
      return N;
  }
  [[nodiscard]] double first_step();
  [[nodiscard]] bool attempt() override;
  [[nodiscard]] bool solve_states(double c);
  void solve_sensitivities(double c) override;
  [[nodiscard]] bool factorise(double c);

  const System& system_;
  double curvature_ = 1e3;  ///< contraction of Newton's iteration per size of the last correction
  Vector state_{}, correction_{}, rate_{}, change_{};
  Matrix matrix_{};
  LuFactorisation<N> lu_;
};

// An error of half of what is allowed:  error_1 h^2 |y''| = 1/2,  y'' = J f where f depends on time by jumps alone. Where
// it depends on time otherwise the error test judges. The columns of S, which it does not see, may start far from rest.
template <int N>
double Bdf<N>::first_step() {
  constexpr double kLongest_s = 1e-3, kError = 0.5;
  for (int row = 0; row < rows(); ++row) {
    change_[row] = 0.0;
    for (int other = 0; other < rows(); ++other) change_[row] += matrix_[row][other] * rate_[other];
  }
  const double curvature = norm(change_.data(), 1);
  if (!std::isfinite(curvature)) return 0.0;
  const double longest = std::min(options_.maximum_step, std::max(step_, kLongest_s));
  return std::min(longest, std::sqrt(kError / (coefficients().error[1] * std::max(curvature, kError))));
}

template <int N>
bool Bdf<N>::start(double time, const double* values) {
  restart(time, values);
  for (int row = 0; row < rows(); ++row) state_[row] = values[row * stride_];
  system_.linearise(time, state_.data(), rate_.data(), matrix_);
  step_ = first_step();
  if (step_ <= 0.0) return false;
  double* slope = differences_[1].data();
  for (int row = 0; row < rows(); ++row)
    for (int other = 0; other < rows(); ++other)
      for (int k = 1; k <= parameters_; ++k)
        slope[row * stride_ + k] += matrix_[row][other] * values[other * stride_ + k];
  system_.add_parameter_derivatives(time, state_.data(), 1.0, slope, stride_);
  for (int row = 0; row < rows(); ++row) slope[row * stride_] = rate_[row];
  for (double& value : differences_[1]) value *= step_;
  return true;
}

template <int N>
bool Bdf<N>::factorise(double c) {
  system_.linearise(time_ + step_, state_.data(), rate_.data(), matrix_);
  ++statistics_.linearisations;
  for (int row = 0; row < rows(); ++row) {
    for (int column = 0; column < rows(); ++column) matrix_[row][column] *= -c;
    matrix_[row][row] += 1.0;
  }
  return lu_.factorise(matrix_, rows());
}

template <int N>
bool Bdf<N>::attempt() {
  predict();
  for (int row = 0; row < rows(); ++row) state_[row] = prediction_[row * stride_];
  std::fill(correction_.begin(), correction_.end(), 0.0);
  if (!solve_states(step_ / coefficients().alpha[order_])) return false;
  error_ = coefficients().error[order_] * norm(correction_.data(), 1);
  return std::isfinite(error_);
}

// Newton's iteration for d = y - y^0:  c f(y^0 + d) - psi - d = 0. The Jacobian is fresh at the prediction and is
// renewed when the iteration contracts slowly. One correction suffices when the last observed contraction says that the
// next one would be far below the allowed error.
template <int N>
bool Bdf<N>::solve_states(double c) {
  constexpr int kIterations = 8;
  constexpr double kConverged = 0.02;  // of the allowed local error
  constexpr double kSlow = 0.2;
  bool fresh = true;
  double last = 0.0;
  if (!factorise(c)) return false;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    for (int row = 0; row < rows(); ++row) change_[row] = c * rate_[row] - constants_[row * stride_] - correction_[row];
    lu_.solve(change_.data());
    const double size_of_change = norm(change_.data(), 1);
    if (!std::isfinite(size_of_change)) return false;
    for (int row = 0; row < rows(); ++row) {
      state_[row] += change_[row];
      correction_[row] += change_[row];
    }
    double contraction = curvature_ * size_of_change;
    if (iteration > 0 && last > 0.0) {
      contraction = size_of_change / last;
      curvature_ = std::max(0.7 * curvature_, contraction / last);
      if (!fresh && contraction > 2.0) return false;
    }
    if (contraction < 1.0 && contraction * size_of_change < kConverged) return true;
    fresh = iteration > 0 && contraction > kSlow;
    if (fresh) {
      if (!factorise(c)) return false;
    } else {
      system_.evaluate(time_ + step_, state_.data(), rate_.data());
    }
    last = size_of_change;
  }
  return false;
}

// (I - c J) S = S^0 + c df/dp - psi_S, all columns at once; work_ <- S - S^0 beside the states' correction.
template <int N>
void Bdf<N>::solve_sensitivities(double c) {
  for (int row = 0; row < rows(); ++row) work_[row * stride_] = correction_[row];
  if (parameters_ == 0) return;
  const std::size_t count = size();
  for (std::size_t j = 0; j < count; ++j) work_[j] = prediction_[j] - constants_[j];
  system_.add_parameter_derivatives(time_ + step_, state_.data(), c, work_.data(), stride_);
  lu_.solve(work_.data(), stride_, stride_);
  for (std::size_t j = 0; j < count; ++j) work_[j] -= prediction_[j];
  for (int row = 0; row < rows(); ++row) work_[row * stride_] = correction_[row];
}

}  // namespace sealwatch

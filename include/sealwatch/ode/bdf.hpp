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
// System is a class with
//   static constexpr int kStates;   or kDynamicSize, with  int states() const;  beside it
//   void evaluate(double t, const double* y, double* f) const;                       f(t, y)
//   void linearise(double t, const double* y, double* f, Matrix& J) const;            f and J
//   void add_parameter_derivatives(double t, const double* y, double factor, double* X, std::size_t stride) const;
//                                                                                     X(:, 1 + k) += factor df/dp_k
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "sealwatch/ode/lu.hpp"

namespace sealwatch {

struct BdfOptions {
  double maximum_step = 1e300;
  std::size_t maximum_steps = 200000;
  int maximum_order = 5;
};

struct BdfStatistics {
  std::size_t steps = 0;
  std::size_t rejected = 0;       ///< by the error test
  std::size_t not_converged = 0;  ///< Newton's iteration failed
  std::size_t linearisations = 0;
};

template <class System>
[[nodiscard]] int state_count(const System& system) {
  if constexpr (System::kStates == kDynamicSize)
    return system.states();
  else
    return System::kStates;
}

template <class System>
class Bdf {
 public:
  static constexpr int kStates = System::kStates;
  static constexpr int kMaximumOrder = 5;
  using Sizes = SquareSystem<kStates>;
  using Matrix = typename Sizes::Matrix;
  using Vector = typename Sizes::Vector;

  /// `parameters`: number of columns of S. `scale`: allowed local error of each state per step.
  Bdf(const System& system, int parameters, const Vector& scale, BdfOptions options = {})
      : system_(system),
        parameters_(parameters),
        stride_(parameters == 0 ? 1 : (1 + parameters + 3) / 4 * 4),
        scale_(scale),
        options_(options) {
    for (auto& difference : differences_) difference.assign(size(), 0.0);
    prediction_.assign(size(), 0.0);
    constants_.assign(size(), 0.0);
    work_.assign(size(), 0.0);
    for (Vector* rows : {&state_, &correction_, &rate_, &change_}) *rows = Sizes::vector(states());
    matrix_ = Sizes::matrix(states());
  }

  [[nodiscard]] std::size_t stride() const { return stride_; }
  [[nodiscard]] int states() const { return state_count(system_); }
  [[nodiscard]] std::size_t size() const { return states() * stride_; }
  [[nodiscard]] double time() const { return time_; }
  [[nodiscard]] double step_size() const { return step_; }
  [[nodiscard]] int order() const { return order_; }
  [[nodiscard]] const BdfStatistics& statistics() const { return statistics_; }
  /// [y | S] at time(), row by row.
  [[nodiscard]] const double* values() const { return differences_[0].data(); }

  /// Starts (again) at time t from [y | S] with first order. The step: by the curvature, at most 1 ms the first time, later
  /// at most that or the last one.
  [[nodiscard]] bool start(double time, const double* values);
  /// One accepted step; false when no step size works.
  [[nodiscard]] bool step();
  /// [y | S] at a time within the last step, to `result`.
  void interpolate(double time, double* result) const;

 private:
  using Table = std::array<double, kMaximumOrder + 3>;
  struct Coefficients {
    Table gamma{}, alpha{}, error{};
  };
  static const Coefficients& coefficients();

  [[nodiscard]] double norm(const double* values, std::size_t stride) const;
  [[nodiscard]] double first_step();
  [[nodiscard]] bool attempt();
  [[nodiscard]] bool solve_states(double c);
  void solve_sensitivities(double c);
  [[nodiscard]] bool factorise(double c);
  void predict();
  void accept();
  void choose_order_and_step();
  void change_step(double factor);

  const System& system_;
  int parameters_;
  std::size_t stride_;
  Vector scale_;
  BdfOptions options_;
  BdfStatistics statistics_;

  double time_ = 0.0;
  double step_ = 0.0;
  int order_ = 1;
  int equal_steps_ = 0;
  double curvature_ = 1e3;  ///< contraction of Newton's iteration per size of the last correction
  double error_ = 0.0;
  std::array<std::vector<double>, kMaximumOrder + 3> differences_;
  std::vector<double> prediction_, constants_, work_;
  Vector state_{}, correction_{}, rate_{}, change_{};
  Matrix matrix_{};
  LuFactorisation<kStates> lu_;
};

}  // namespace sealwatch

#include "sealwatch/ode/bdf_implementation.hpp"

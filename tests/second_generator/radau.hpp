// Radau IIA with three stages, order 5, for stiff y' = f(t, y) (Hairer and Wanner, Solving Ordinary Differential
// Equations II, section IV.8): variable step, simplified Newton iteration on all stages at once, Jacobian by differences
// at every step, embedded error estimate of order 3.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <vector>

namespace second_generator {

using Vector = std::vector<double>;

// LU factors of a dense square matrix, with partial pivoting.
class Lu {
 public:
  Lu(Vector matrix, int n) : a_(std::move(matrix)), pivot_(std::size_t(n)), n_(n) {
    for (int k = 0; k < n_; ++k) eliminate(k);
  }

  void solve(Vector& b) const {
    for (int k = 0; k < n_; ++k) std::swap(b[k], b[pivot_[k]]);  // whole rows were exchanged
    for (int k = 0; k < n_; ++k) {
      for (int i = k + 1; i < n_; ++i) b[i] -= a_[i * n_ + k] * b[k];
    }
    for (int i = n_ - 1; i >= 0; --i) {
      for (int j = i + 1; j < n_; ++j) b[i] -= a_[i * n_ + j] * b[j];
      b[i] /= a_[i * n_ + i];
    }
  }

 private:
  void eliminate(int k) {
    int p = k;
    for (int i = k + 1; i < n_; ++i)
      if (std::abs(a_[i * n_ + k]) > std::abs(a_[p * n_ + k])) p = i;
    pivot_[k] = p;
    if (p != k) std::swap_ranges(&a_[k * n_], &a_[k * n_] + n_, &a_[p * n_]);
    for (int i = k + 1; i < n_; ++i) {
      const double factor = a_[i * n_ + k] / a_[k * n_ + k];
      a_[i * n_ + k] = factor;
      if (factor == 0.0) continue;
      for (int j = k + 1; j < n_; ++j) a_[i * n_ + j] -= factor * a_[k * n_ + j];
    }
  }

  Vector a_;
  std::vector<int> pivot_;
  int n_;
};

class Radau {
 public:
  using Rates = std::function<void(double t, const Vector& y, Vector& dy)>;

  // scale: the absolute error that is tolerated in each state, in the state's unit; beside it 1e-7 of the state's size.
  Radau(Rates rates, Vector scale) : rates_(std::move(rates)), scale_(std::move(scale)), n_(int(scale_.size())) {}

  // Takes y from t to end. Throws std::runtime_error where no finite solution is found.
  void advance(double t, double end, Vector& y) {
    while (end - t > 1e-12) {
      const double left = end - t;
      const double h = step_ >= left ? left : (step_ > 0.5 * left ? 0.5 * left : step_);
      if (try_step(t, h, y)) t += h;
    }
  }

 private:
  static constexpr double kSmallestStep = 1e-7;  // s: here a corner is crossed, and the step is taken as it is

  void differentiate(double t, const Vector& y, const Vector& f) {
    jacobian_.assign(std::size_t(n_ * n_), 0.0);
    Vector moved = y, g(y.size());
    for (int j = 0; j < n_; ++j) {
      const double d = 1e-7 * std::abs(y[j]) + 0.1 * scale_[j];
      moved[j] = y[j] + d;
      rates_(t, moved, g);
      for (int i = 0; i < n_; ++i) jacobian_[i * n_ + j] = (g[i] - f[i]) / d;
      moved[j] = y[j];
    }
  }

  double norm(const Vector& e, const Vector& y, int stages) const {
    double sum = 0.0;
    for (int s = 0; s < stages; ++s)
      for (int i = 0; i < n_; ++i) {
        const double q = e[s * n_ + i] / (scale_[i] + 1e-7 * std::abs(y[i]));
        sum += q * q;
      }
    return std::sqrt(sum / (stages * n_));
  }

  // Solves z_s = h sum_r A_sr f(t + c_r h, y + z_r); false where the iteration does not contract.
  bool solve_stages(double t, double h, const Vector& y, Vector& z) const;

  bool try_step(double t, double h, Vector& y) {
    Vector f(y.size()), z(std::size_t(3 * n_), 0.0);
    rates_(t, y, f);
    differentiate(t, y, f);
    const bool forced = h <= kSmallestStep;
    if (!solve_stages(t, h, y, z) && !forced) {
      step_ = 0.3 * h;
      return false;
    }
    const double error = forced ? 0.5 : estimate_error(h, y, f, z);
    if (!std::isfinite(error)) throw std::runtime_error("the integration does not end in finite numbers");
    step_ = std::max(h * std::clamp(0.9 * std::pow(std::max(error, 1e-10), -0.25), 0.2, 6.0), kSmallestStep);
    if (error > 1.0) return false;
    for (int i = 0; i < n_; ++i) y[i] += z[2 * n_ + i];
    return true;
  }

  double estimate_error(double h, const Vector& y, const Vector& f, const Vector& z) const {
    static const double r6 = std::sqrt(6.0);
    static const double gamma = 30.0 / (6.0 + std::cbrt(81.0) - std::cbrt(9.0));
    Vector matrix(jacobian_.size()), e(y.size());
    for (int i = 0; i < n_; ++i) {
      for (int j = 0; j < n_; ++j) matrix[i * n_ + j] = -jacobian_[i * n_ + j] + (i == j ? gamma / h : 0.0);
      e[i] = f[i] + (-(13.0 + 7.0 * r6) / 3.0 * z[i] + (-13.0 + 7.0 * r6) / 3.0 * z[n_ + i] - z[2 * n_ + i] / 3.0) / h;
    }
    Lu(std::move(matrix), n_).solve(e);
    return norm(e, y, 1);
  }

  Rates rates_;
  Vector scale_, jacobian_;
  int n_;
  double step_ = 1e-4;
};

inline bool Radau::solve_stages(double t, double h, const Vector& y, Vector& z) const {
  static const double r6 = std::sqrt(6.0);
  static const std::array<double, 3> c = {(4.0 - r6) / 10.0, (4.0 + r6) / 10.0, 1.0};
  static const double a[3][3] = {{(88.0 - 7.0 * r6) / 360.0, (296.0 - 169.0 * r6) / 1800.0, (-2.0 + 3.0 * r6) / 225.0},
                                 {(296.0 + 169.0 * r6) / 1800.0, (88.0 + 7.0 * r6) / 360.0, (-2.0 - 3.0 * r6) / 225.0},
                                 {(16.0 - r6) / 36.0, (16.0 + r6) / 36.0, 1.0 / 9.0}};
  const int m = 3 * n_;
  Vector matrix(std::size_t(m * m));
  for (int s = 0; s < 3; ++s)
    for (int r = 0; r < 3; ++r)
      for (int i = 0; i < n_; ++i)
        for (int j = 0; j < n_; ++j)
          matrix[(s * n_ + i) * m + r * n_ + j] = (s == r && i == j ? 1.0 : 0.0) - h * a[s][r] * jacobian_[i * n_ + j];
  const Lu lu(std::move(matrix), m);
  std::array<Vector, 3> f = {Vector(y.size()), Vector(y.size()), Vector(y.size())};
  Vector stage(y.size()), residual(std::size_t(m), 0.0);
  double before = 0.0;
  for (int iteration = 0; iteration < 8; ++iteration) {
    for (int s = 0; s < 3; ++s) {
      for (int i = 0; i < n_; ++i) stage[i] = y[i] + z[s * n_ + i];
      rates_(t + c[s] * h, stage, f[s]);
    }
    for (int s = 0; s < 3; ++s)
      for (int i = 0; i < n_; ++i)
        residual[s * n_ + i] = h * (a[s][0] * f[0][i] + a[s][1] * f[1][i] + a[s][2] * f[2][i]) - z[s * n_ + i];
    lu.solve(residual);
    for (int k = 0; k < m; ++k) z[k] += residual[k];
    const double change = norm(residual, y, 3);
    if (!std::isfinite(change) || (iteration > 1 && change > 2.0 * before)) return false;
    if (change < 0.02) return true;
    before = change;
  }
  return false;
}

}  // namespace second_generator

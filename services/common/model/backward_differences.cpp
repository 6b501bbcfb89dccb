#include "sealwatch/ode/backward_differences.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "sealwatch/core/wide_vectors.hpp"

namespace sealwatch {
namespace {

constexpr int kDifferences = BackwardDifferences::kMaximumOrder + 1;  // D_0 to D_5
using Weights = std::array<double, kDifferences>;
using Rows = std::array<const double*, kDifferences>;

// w_0 D_0 + ... + w_k D_k in one pass.
template <int K>
[[gnu::always_inline]] inline void weighted_sum_of(const Weights& w, const Rows& d, std::size_t count, double* result) {
  for (std::size_t j = 0; j < count; ++j) {
    double sum = w[0] * d[0][j];
    for (int m = 1; m <= K; ++m) sum += w[m] * d[m][j];
    result[j] = sum;
  }
}

SEALWATCH_WIDE_VECTORS
void weighted_sum(int k, const Weights& w, const Rows& d, std::size_t count, double* result) {
  switch (k) {
    case 1:
      return weighted_sum_of<1>(w, d, count, result);
    case 2:
      return weighted_sum_of<2>(w, d, count, result);
    case 3:
      return weighted_sum_of<3>(w, d, count, result);
    case 4:
      return weighted_sum_of<4>(w, d, count, result);
    default:
      return weighted_sum_of<5>(w, d, count, result);
  }
}

// D_(k+2) = e - D_(k+1), D_(k+1) = e, and every lower difference grows by the one above it.
SEALWATCH_WIDE_VECTORS
void renew(const std::array<double*, BackwardDifferences::kMaximumOrder + 3>& d, int order, const double* e,
           std::size_t count) {
  std::size_t j = 0;
  for (; j + kWidth <= count; j += kWidth) {
    WideVector above, next;
    std::memcpy(&above, e + j, sizeof(above));
    std::memcpy(&next, d[order + 1] + j, sizeof(next));
    next = above - next;
    std::memcpy(d[order + 2] + j, &next, sizeof(next));
    std::memcpy(d[order + 1] + j, &above, sizeof(above));
    for (int m = order; m >= 0; --m) {
      std::memcpy(&next, d[m] + j, sizeof(next));
      above += next;
      std::memcpy(d[m] + j, &above, sizeof(above));
    }
  }
  for (; j < count; ++j) {
    double above = e[j];
    d[order + 2][j] = above - d[order + 1][j];
    d[order + 1][j] = above;
    for (int m = order; m >= 0; --m) above = d[m][j] += above;
  }
}

using Square = std::array<std::array<double, kDifferences>, kDifferences>;

// D_j = sum_k product_kj D_k for j, k = 1 .. n - 1. Some positions at a time: all differences of these stay in the nearest
// cache, and each row is one vector operation.
SEALWATCH_WIDE_VECTORS
void transform(const Square& product, int n, const std::array<double*, kDifferences>& d, std::size_t size) {
  constexpr std::size_t kTogether = 32;
  double old[kDifferences][kTogether];
  for (std::size_t first = 0; first < size; first += kTogether) {
    const std::size_t count = std::min(kTogether, size - first);
    for (int k = 1; k < n; ++k)
      for (std::size_t p = 0; p < count; ++p) old[k][p] = d[k][first + p];
    for (int j = 1; j < n; ++j) {
      double* difference = d[j] + first;
      for (std::size_t p = 0; p < count; ++p) difference[p] = product[1][j] * old[1][p];
      for (int k = 2; k < n; ++k)
        for (std::size_t p = 0; p < count; ++p) difference[p] += product[k][j] * old[k][p];
    }
  }
}

}  // namespace

BackwardDifferences::BackwardDifferences(int states, int parameters, std::vector<double> scale, BdfOptions options)
    : parameters_(parameters),
      stride_(parameters == 0 ? 1 : (1 + parameters + 3) / 4 * 4),
      scale_(std::move(scale)),
      options_(options),
      states_(states) {
  for (auto& difference : differences_) difference.assign(size(), 0.0);
  prediction_.assign(size(), 0.0);
  constants_.assign(size(), 0.0);
  work_.assign(size(), 0.0);
}

// kappa, gamma, alpha = (1 - kappa) gamma and error constants kappa gamma + 1/(k+1) of Shampine and Reichelt, table 1.
const BackwardDifferences::Coefficients& BackwardDifferences::coefficients() {
  static constexpr Coefficients table = [] {
    constexpr std::array kappa = {0.0, -0.1850, -1.0 / 9.0, -0.0823, -0.0415, 0.0};
    Coefficients c;
    for (int k = 0; k <= kMaximumOrder; ++k) {
      c.gamma[k] = k == 0 ? 0.0 : c.gamma[k - 1] + 1.0 / k;
      c.alpha[k] = (1.0 - kappa[k]) * c.gamma[k];
      c.error[k] = kappa[k] * c.gamma[k] + 1.0 / (k + 1);
    }
    return c;
  }();
  return table;
}

double BackwardDifferences::norm(const double* values, std::size_t stride) const {
  double largest = 0.0;
  for (int row = 0; row < states_; ++row) {
    const double ratio = std::abs(values[row * stride]) / scale_[row];
    if (!(ratio <= largest)) largest = ratio;  // keeps NaN
  }
  return largest;
}

void BackwardDifferences::restart(double time, const double* values) {
  time_ = time;
  order_ = 1;
  equal_steps_ = 0;
  for (auto& difference : differences_) std::fill(difference.begin(), difference.end(), 0.0);
  std::copy(values, values + size(), differences_[0].begin());
}

bool BackwardDifferences::step() {
  for (int tries = 0; tries < 60; ++tries) {
    if (statistics_.steps >= options_.maximum_steps || time_ + step_ <= time_) return false;
    if (step_ > options_.maximum_step) change_step(options_.maximum_step / step_);
    if (!attempt()) {
      ++statistics_.not_converged;
      change_step(0.3);
      continue;
    }
    if (error_ > 1.0) {
      ++statistics_.rejected;
      change_step(std::max(0.2, 0.8 * std::pow(error_, -1.0 / (order_ + 1))));
      continue;
    }
    solve_sensitivities(step_ / coefficients().alpha[order_]);
    accept();
    choose_order_and_step();
    return true;
  }
  return false;
}

// y^0 = sum D_m and psi = sum gamma_m D_m / alpha_k, for all columns.
void BackwardDifferences::predict() {
  const auto& c = coefficients();
  Weights one{1.0}, weight{};
  for (int m = 1; m <= order_; ++m) {
    one[m] = 1.0;
    weight[m] = c.gamma[m] / c.alpha[order_];
  }
  weighted_sum(order_, one, differences(), size(), prediction_.data());
  weighted_sum(order_, weight, differences(), size(), constants_.data());
}

void BackwardDifferences::accept() {
  ++statistics_.steps;
  time_ += step_;
  ++equal_steps_;
  std::array<double*, kMaximumOrder + 3> d;
  for (std::size_t m = 0; m < d.size(); ++m) d[m] = differences_[m].data();
  renew(d, order_, work_.data(), size());
}

// After order + 1 equal steps: the order, one lower or one higher, that allows the largest next step.
void BackwardDifferences::choose_order_and_step() {
  if (equal_steps_ < order_ + 1) return;
  const auto& c = coefficients();
  const auto factor = [&](double error, int order) { return error > 0.0 ? std::pow(error, -1.0 / (order + 1)) : 10.0; };
  double best = factor(error_, order_);
  int best_order = order_;
  if (order_ > 1) {
    const double lower = factor(c.error[order_ - 1] * norm(differences_[order_].data(), stride_), order_ - 1);
    if (lower > best) best = lower, best_order = order_ - 1;
  }
  if (order_ < std::min(options_.maximum_order, kMaximumOrder)) {
    const double higher = factor(c.error[order_ + 1] * norm(differences_[order_ + 2].data(), stride_), order_ + 1);
    if (higher > best) best = higher, best_order = order_ + 1;
  }
  order_ = best_order;
  const double change = std::min(10.0, 0.9 * best);
  if (change >= 1.0 && change < 1.1) return;  // not worth the loss of accuracy that every change brings
  change_step(std::min(change, options_.maximum_step / step_));
}

// Differences for the step factor * h from those for h: D' = (R(factor) R(1))^T D.
void BackwardDifferences::change_step(double factor) {
  const int n = order_ + 1;
  const auto polynomial = [n](double ratio) {
    Square r{};
    for (int j = 0; j < n; ++j) r[0][j] = 1.0;
    for (int i = 1; i < n; ++i)
      for (int j = 1; j < n; ++j) r[i][j] = r[i - 1][j] * (i - 1 - ratio * j) / i;
    return r;
  };
  const Square r = polynomial(factor), u = polynomial(1.0);
  Square product{};
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) product[i][j] += r[i][k] * u[k][j];
  std::array<double*, kDifferences> d;
  for (int m = 0; m < kDifferences; ++m) d[m] = differences_[m].data();
  transform(product, n, d, size());
  step_ *= factor;
  equal_steps_ = 0;
}

// y(t) = D_0 + sum_m D_m prod_(i<m) (t - t_(n-i)) / ((i + 1) h)
void BackwardDifferences::interpolate(double time, double* result) const {
  Weights weight{1.0};
  for (int m = 1; m <= order_; ++m) weight[m] = weight[m - 1] * (time - (time_ - step_ * (m - 1))) / (m * step_);
  weighted_sum(order_, weight, differences(), size(), result);
}

std::array<const double*, BackwardDifferences::kMaximumOrder + 1> BackwardDifferences::differences() const {
  std::array<const double*, kMaximumOrder + 1> d;
  for (int m = 0; m <= kMaximumOrder; ++m) d[m] = differences_[m].data();
  return d;
}

}  // namespace sealwatch

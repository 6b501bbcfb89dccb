#include "sealwatch/ode/backward_differences.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sealwatch {

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
  static const Coefficients table = [] {
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
  const std::size_t count = size();
  std::copy(differences_[0].begin(), differences_[0].end(), prediction_.begin());
  std::fill(constants_.begin(), constants_.end(), 0.0);
  for (int m = 1; m <= order_; ++m) {
    const double weight = c.gamma[m] / c.alpha[order_];
    const double* difference = differences_[m].data();
    double* prediction = prediction_.data();
    double* constants = constants_.data();
    for (std::size_t j = 0; j < count; ++j) {
      prediction[j] += difference[j];
      constants[j] += weight * difference[j];
    }
  }
}

void BackwardDifferences::accept() {
  ++statistics_.steps;
  time_ += step_;
  ++equal_steps_;
  const std::size_t count = size();
  double* d2 = differences_[order_ + 2].data();
  double* d1 = differences_[order_ + 1].data();
  for (std::size_t j = 0; j < count; ++j) {
    d2[j] = work_[j] - d1[j];
    d1[j] = work_[j];
  }
  for (int m = order_; m >= 0; --m) {
    double* lower = differences_[m].data();
    const double* upper = differences_[m + 1].data();
    for (std::size_t j = 0; j < count; ++j) lower[j] += upper[j];
  }
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
  using Square = std::array<std::array<double, kMaximumOrder + 1>, kMaximumOrder + 1>;
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
  // Some positions at a time: all differences of these stay in the nearest cache, and each row is one vector operation.
  constexpr std::size_t kTogether = 32;
  std::array<std::array<double, kTogether>, kMaximumOrder + 1> old;
  for (std::size_t first = 0; first < size(); first += kTogether) {
    const std::size_t count = std::min(kTogether, size() - first);
    for (int k = 1; k <= kMaximumOrder; ++k) std::copy_n(differences_[k].data() + first, count, old[k].data());
    for (int j = 1; j < n; ++j) {
      double* difference = differences_[j].data() + first;
      for (std::size_t p = 0; p < count; ++p) difference[p] = product[1][j] * old[1][p];
      for (int k = 2; k < n; ++k)
        for (std::size_t p = 0; p < count; ++p) difference[p] += product[k][j] * old[k][p];
    }
  }
  step_ *= factor;
  equal_steps_ = 0;
}

// y(t) = D_0 + sum_m D_m prod_(i<m) (t - t_(n-i)) / ((i + 1) h)
void BackwardDifferences::interpolate(double time, double* result) const {
  // One pass over the columns with all five terms (those beyond the order have weight zero): faster than one pass for
  // each.
  std::array<double, kMaximumOrder + 1> weight{1.0};
  for (int m = 1; m <= order_; ++m) weight[m] = weight[m - 1] * (time - (time_ - step_ * (m - 1))) / (m * step_);
  std::array<const double*, kMaximumOrder + 1> d;
  for (int m = 0; m <= kMaximumOrder; ++m) d[m] = differences_[m].data();
  const std::size_t count = size();
  for (std::size_t j = 0; j < count; ++j)
    result[j] = d[0][j] + weight[1] * d[1][j] + weight[2] * d[2][j] + weight[3] * d[3][j] + weight[4] * d[4][j] +
                weight[5] * d[5][j];
}

}  // namespace sealwatch

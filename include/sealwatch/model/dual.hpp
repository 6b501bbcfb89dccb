// Forward-mode automatic differentiation with N directions at once.
//
//   Dual<2> x = Dual<2>::variable(3.0, 0), y = Dual<2>::variable(4.0, 1);
//   Dual<2> z = x * sqrt(y);   // z.value = 6, z.derivative = {2, 0.75}
//
// Rule for every function g: g(x + e) = g(x) + g'(x) e, e^2 = 0. Loops over the directions have a compile-time length,
// so that the compiler unrolls and vectorises them. Functions are found by argument-dependent look-up; write `using
// std::exp;` where plain doubles may come too (model/laws.hpp does).
#pragma once

#include <array>
#include <cmath>

namespace sealwatch {

template <int N>
struct Dual {
  double value = 0.0;
  std::array<double, N> derivative{};

  Dual() = default;
  Dual(double constant) : value(constant) {}  // NOLINT: a plain number is a constant

  [[nodiscard]] static Dual variable(double value, int direction) {
    Dual x(value);
    x.derivative[static_cast<std::size_t>(direction)] = 1.0;
    return x;
  }

  /// g(x) from its value and slope at x: the chain rule.
  [[nodiscard]] Dual chain(double function, double slope) const {
    Dual result;
    result.value = function;
    for (int k = 0; k < N; ++k) result.derivative[k] = slope * derivative[k];
    return result;
  }

  Dual& operator+=(const Dual& b) {
    value += b.value;
    for (int k = 0; k < N; ++k) derivative[k] += b.derivative[k];
    return *this;
  }
  Dual& operator-=(const Dual& b) {
    value -= b.value;
    for (int k = 0; k < N; ++k) derivative[k] -= b.derivative[k];
    return *this;
  }

  friend Dual operator+(Dual a, const Dual& b) { return a += b; }
  friend Dual operator-(Dual a, const Dual& b) { return a -= b; }
  friend Dual operator-(const Dual& a) { return a.chain(-a.value, -1.0); }
  friend Dual operator*(const Dual& a, const Dual& b) { return combine(a.value * b.value, a, b.value, b, a.value); }
  friend Dual operator/(const Dual& a, const Dual& b) {
    const double inverse = 1.0 / b.value;
    const double quotient = a.value * inverse;
    return combine(quotient, a, inverse, b, -quotient * inverse);
  }

  friend Dual operator+(Dual a, double b) { return a.value += b, a; }
  friend Dual operator+(double a, Dual b) { return b.value += a, b; }
  friend Dual operator-(Dual a, double b) { return a.value -= b, a; }
  friend Dual operator-(double a, const Dual& b) { return b.chain(a - b.value, -1.0); }
  friend Dual operator*(const Dual& a, double b) { return a.chain(a.value * b, b); }
  friend Dual operator*(double a, const Dual& b) { return b.chain(a * b.value, a); }
  friend Dual operator/(const Dual& a, double b) { return a.chain(a.value / b, 1.0 / b); }
  friend Dual operator/(double a, const Dual& b) { return b.chain(a / b.value, -a / (b.value * b.value)); }

 private:
  [[nodiscard]] static Dual combine(double function, const Dual& a, double slope_a, const Dual& b, double slope_b) {
    Dual result;
    result.value = function;
    for (int k = 0; k < N; ++k) result.derivative[k] = slope_a * a.derivative[k] + slope_b * b.derivative[k];
    return result;
  }
};

template <int N>
[[nodiscard]] Dual<N> exp(const Dual<N>& x) {
  const double e = std::exp(x.value);
  return x.chain(e, e);
}
template <int N>
[[nodiscard]] Dual<N> log(const Dual<N>& x) {
  return x.chain(std::log(x.value), 1.0 / x.value);
}
template <int N>
[[nodiscard]] Dual<N> log1p(const Dual<N>& x) {
  return x.chain(std::log1p(x.value), 1.0 / (1.0 + x.value));
}
template <int N>
[[nodiscard]] Dual<N> sqrt(const Dual<N>& x) {
  const double root = std::sqrt(x.value);
  return x.chain(root, 0.5 / root);
}
template <int N>
[[nodiscard]] Dual<N> tanh(const Dual<N>& x) {
  const double t = std::tanh(x.value);
  return x.chain(t, 1.0 - t * t);
}
/// The slope at 0 is taken as 1: laws that need |x| at 0 regularise it themselves.
template <int N>
[[nodiscard]] Dual<N> abs(const Dual<N>& x) {
  return x.value < 0.0 ? -x : x;
}
/// x^n for a constant exponent.
template <int N>
[[nodiscard]] Dual<N> pow(const Dual<N>& x, double exponent) {
  const double power = std::pow(x.value, exponent);
  return x.chain(power, exponent * std::pow(x.value, exponent - 1.0));
}

[[nodiscard]] inline double value_of(double x) { return x; }
template <int N>
[[nodiscard]] double value_of(const Dual<N>& x) {
  return x.value;
}

}  // namespace sealwatch

// Element laws of hydraulic actuators, templated on the scalars (double or Dual), SI units. Every law is smooth: where
// the physics has a corner (no flow, standstill, an end stop) it is rounded over a stated width, and a test checks
// value and derivative there.
#pragma once

#include <cmath>

#include "sealwatch/model/dual.hpp"

namespace sealwatch::laws {

/// Logistic switch 1 / (1 + exp(-2 a)) = (1 + tanh a) / 2: 0 far below a = 0, 1 far above.
template <class A>
[[nodiscard]] auto smooth_step(const A& a) {
  using std::exp;
  if (value_of(a) > 0.0) return 1.0 / (1.0 + exp(-2.0 * a));
  const auto e = exp(2.0 * a);
  return e / (1.0 + e);
}

/// Positive part of a, rounded over the width s: s ln(1 + exp(a / s)).
template <class A, class S>
[[nodiscard]] auto smooth_positive(const A& a, const S& s) {
  using std::exp;
  using std::log1p;
  using R = decltype(a / s);
  const R ratio = a / s;
  if (value_of(ratio) > 40.0) return R(a + s * R(0.0));  // exp(-40) is below rounding
  if (value_of(ratio) < -700.0) return R(0.0);
  return R(s * log1p(exp(ratio)));
}

/// |a|, rounded over the width s: sqrt(a^2 + s^2) - s; zero at zero.
template <class A>
[[nodiscard]] auto smooth_abs(const A& a, double s) {
  using std::sqrt;
  return sqrt(a * a + s * s) - s;
}

/// Signed square root of a pressure drop D: D / sqrt(|D| + eps), linear for |D| << eps. [sqrt(Pa)]
template <class D, class E>
[[nodiscard]] auto signed_root(const D& drop, const E& eps) {
  using std::abs;
  using std::sqrt;
  return drop / sqrt(abs(drop) + eps);
}

/// Turbulent flow through an orifice: q = c_D a sqrt(2 / rho) D / sqrt(|D| + eps). Positive in the direction of D.
/// [m3/s]
template <class C, class A, class Rho, class D, class E>
[[nodiscard]] auto orifice_flow(const C& discharge, const A& area, const Rho& density, const D& drop, const E& eps) {
  using std::sqrt;
  return discharge * area * sqrt(2.0 / density) * signed_root(drop, eps);
}

/// Laminar leakage through a gap of resistance R: q = D / R. [m3/s]
template <class D, class R>
[[nodiscard]] auto laminar_flow(const D& drop, const R& resistance) {
  return drop / resistance;
}

/// Flow from a reservoir at p_0 that feeds only: q = K s ln(1 + exp((p_0 - p) / s)). [m3/s]
template <class K, class P0, class P, class S>
[[nodiscard]] auto make_up_flow(const K& conductance, const P0& reservoir, const P& pressure, const S& width) {
  return conductance * smooth_positive(reservoir - pressure, width);
}

/// Force of an end stop that acts at depth > 0 (spring k, damper d against motion into the end at the speed `into`),
/// rounded over 20 micrometres of depth and 10 micrometres a second. Positive away from the end. [N]
template <class D, class V, class K, class C>
[[nodiscard]] auto end_stop_force(const D& depth, const V& into, const K& stiffness, const C& damping) {
  using std::sqrt;
  using R = decltype(stiffness * depth + damping * into);
  constexpr double kDepth_m = 2e-5;
  constexpr double kSpeed_m_s = 1e-5;
  if (value_of(depth) < -40.0 * kDepth_m) return R(0.0);
  const auto engaged = smooth_step(depth / (2.0 * kDepth_m));
  const auto approach = 0.5 * (into + sqrt(into * into + kSpeed_m_s * kSpeed_m_s) - kSpeed_m_s);
  return R(stiffness * smooth_positive(depth, kDepth_m) + damping * engaged * approach);
}

}  // namespace sealwatch::laws

// Laws at random points, for the tests of the catalogue.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "sealwatch/model/law_sizes.hpp"
#include "sealwatch/model/physics.hpp"

namespace sealwatch::law_test {

/// Sizes of the signals of a site, as in a test of plant `eha` (or of the cascaded tanks).
inline std::array<double, kSiteSignals> signal_scales(SiteKind kind) {
  switch (kind) {
    case SiteKind::voltage_command:
      return {5.0, 30.0, 100.0, 1.0};
    case SiteKind::winding_voltage:
      return {5.0, 200.0, 1.0, 1.0};
    case SiteKind::shaft_torque:
      return {200.0, 1e7, 5.0, 1.0};
    case SiteKind::pump_slip:
      return {1e7, 200.0, 1.0, 1.0};
    case SiteKind::line_drop:
      return {8e-6, 1e5, 1.0, 1.0};
    case SiteKind::valve_crack:
      return {1e5, 8e-6, 1.0, 1.0};
    case SiteKind::seal_leakage:
      return {1e7, 1.3e-3, 0.06, 1.0};
    case SiteKind::piston_force:
      return {1.3e-3, 0.06, 1.1e7, 1e6};
    case SiteKind::viscosity:
      return {150.0, 1.0, 1.0, 1.0};
    case SiteKind::tank_flow:
      return {10.0, 10.0, 1.0, 1.0};
    default:  // pressures
      return {1e7, 1.0, 1.0, 1.0};
  }
}

inline std::string name_of(const Law& law) {
  std::string name(law.id);
  if (!law.form.empty()) name.append(" (").append(law.form).append(")");
  return name;
}

/// Signals, hidden state and parameters of one evaluation, as plain numbers.
struct Point {
  std::array<double, kSiteSignals> signal{};
  double hidden = 0.0;
  std::array<double, kLawParameters> parameter{};

  [[nodiscard]] double& direction(std::size_t k) {
    if (k < kSiteSignals) return signal[k];
    return k == kSiteSignals ? hidden : parameter[k - kSiteSignals - 1];
  }
};

inline LawOutput output_at(const Law& law, const Point& point) {
  return law.evaluate(law_input(point.signal, point.hidden, std::span(point.parameter).first(law.parameters.size()),
                                roundings_of(law)));
}

/// Random signals of either sign and of any size up to the usual, which of them is zero by `zero_signal`; each shape
/// one of its grid, each strength up to twice the usual.
inline Point random_point(const Law& law, std::mt19937& random, std::size_t zero_signal = kSiteSignals) {
  std::uniform_real_distribution<double> sign(-1.0, 1.0);
  std::uniform_real_distribution<double> decades(-2.0, 0.3);
  const auto any = [&](double scale) { return std::copysign(scale * std::pow(10.0, decades(random)), sign(random)); };
  Point point;
  const auto scale = signal_scales(law.kind);
  for (std::size_t k = 0; k < kSiteSignals; ++k) point.signal[k] = k == zero_signal ? 0.0 : any(scale[k]);
  if (law.hidden) point.hidden = law.hidden->scale * sign(random);
  for (std::size_t k = 0; k < law.parameters.size(); ++k) {
    const LawParameter& p = law.parameters[k];
    std::uniform_int_distribution<std::size_t> grid(0, p.start.size() - 1);
    point.parameter[k] =
        p.strength ? std::clamp(p.start[0] * (1.0 + sign(random)), p.min, p.max) : p.start[grid(random)];
  }
  return point;
}

inline std::vector<const Law*> evaluated_laws() {
  std::vector<const Law*> laws;
  for (const Law& law : all_laws())
    if (law.evaluate != nullptr) laws.push_back(&law);
  return laws;
}

}  // namespace sealwatch::law_test

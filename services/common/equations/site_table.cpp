#include "services/common/equations/site_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "sealwatch/model/law_sizes.hpp"

namespace sealwatch::equations {
namespace {

constexpr SignalName kNone{};
constexpr SignalName kCurrent{"current", "A", 5.0};
constexpr SignalName kShaftSpeed{"speed", "rad/s", 100.0};
constexpr SignalName kPumpPressure{"pressure_difference", "Pa", 1e7};
constexpr SignalName kFlow{"flow", "m3/s", 1e-5};
constexpr SignalName kDrop{"drop", "Pa", 1e5};
constexpr SignalName kSpeed{"speed", "m/s", 1e-3};
constexpr SignalName kPosition{"position", "m", 0.05};
constexpr SignalName kPressure{"pressure", "Pa", 1e7};

constexpr SiteNames kCommand{"V", {kCurrent, {"command", "V", 20.0}, {"command_rate", "V/s", 10.0}, kNone}};
constexpr SiteNames kWinding{"V", {kCurrent, kShaftSpeed, kNone, kNone}};
constexpr SiteNames kTorque{"N m", {kShaftSpeed, kPumpPressure, kCurrent, kNone}};
constexpr SiteNames kSlip{"m3/s", {kPumpPressure, kShaftSpeed, kNone, kNone}};
constexpr SiteNames kLine{"Pa", {kFlow, kDrop, kNone, kNone}};
constexpr SiteNames kCrack{"Pa", {kDrop, kFlow, kNone, kNone}};
constexpr SiteNames kOutflow{"m3/s", {kPressure, kNone, kNone, kNone}};
constexpr SiteNames kCompliance{"m3/Pa", {kPressure, kNone, kNone, kNone}};
constexpr SiteNames kSeal{"m3/s", {kPumpPressure, kSpeed, kPosition, kNone}};
constexpr SiteNames kForce{"N", {kSpeed, kPosition, {"pressure_a", "Pa", 1e7}, {"pressure_b", "Pa", 1e6}}};
constexpr SiteNames kModulus{"1/Pa", {kPressure, kNone, kNone, kNone}};
constexpr SiteNames kViscosity{"1", {SignalName{"power", "W", 50.0}, kNone, kNone, kNone}};
constexpr SiteNames kTank{"V/s", {SignalName{"level", "V", 5.0}, kNone, kNone, kNone}};
constexpr SiteNames kOwn{"", {kNone, kNone, kNone, kNone}};

}  // namespace

const SiteNames& names_of_site(SiteKind kind) {
  switch (kind) {
    case SiteKind::voltage_command:
      return kCommand;
    case SiteKind::winding_voltage:
      return kWinding;
    case SiteKind::shaft_torque:
      return kTorque;
    case SiteKind::pump_slip:
      return kSlip;
    case SiteKind::line_drop:
      return kLine;
    case SiteKind::valve_crack:
      return kCrack;
    case SiteKind::outflow:
      return kOutflow;
    case SiteKind::compliance:
      return kCompliance;
    case SiteKind::seal_leakage:
      return kSeal;
    case SiteKind::piston_force:
      return kForce;
    case SiteKind::inverse_modulus:
      return kModulus;
    case SiteKind::viscosity:
      return kViscosity;
    case SiteKind::tank_flow:
      return kTank;
    default:
      return kOwn;
  }
}

bool is_inert(const Law& law, const Site& site) {
  if (std::ranges::none_of(site.absent, std::identity{})) return false;
  constexpr double kRounding = 0.01;
  const SiteNames& names = names_of_site(site.kind);
  std::array<double, kSiteSignals> seen{}, all{};
  for (std::size_t k = 0; k < kSiteSignals; ++k) {
    all[k] = names.signals[k].usual;
    if (!site.absent[k]) seen[k] = all[k];
  }
  std::vector<double> parameters;
  for (const LawParameter& parameter : law.parameters) parameters.push_back(parameter.start.front());
  const double hidden = law.hidden ? law.hidden->scale : 0.0;
  const LawOutput here = law.evaluate(law_input(seen, hidden, parameters, roundings_of(law)));
  const LawOutput usual = law.evaluate(law_input(all, hidden, parameters, roundings_of(law)));
  const auto less = [](const LawScalar& a, const LawScalar& b) {
    return std::abs(a.value) <= kRounding * std::abs(b.value);
  };
  return less(here.contribution, usual.contribution) && less(here.rate, usual.rate);
}

}  // namespace sealwatch::equations

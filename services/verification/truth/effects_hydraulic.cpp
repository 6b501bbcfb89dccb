// Flows, volumes and the oil itself.
#include <algorithm>
#include <array>
#include <cmath>

#include "services/verification/truth/effects.hpp"

namespace sealwatch::bench {
namespace {

constexpr double kReservoir_Pa = 1.0e6;
constexpr double kUsualFlow_m3_s = 8e-6;  // of a partial stroke test's ramp

// k sgn(D) sqrt(|D|) tanh(sqrt(|D| / D_c)): discharge coefficient that grows with the Reynolds number
double orifice_with_transition(double drop, double k, double critical_Pa) {
  const double root = std::sqrt(std::abs(drop));
  return std::copysign(k * root * std::tanh(root / std::sqrt(critical_Pa)), drop);
}

// Flow of D = q / G + c q |q|: a gap that is laminar at first
double gap_flow(double drop, double conductance, double quadratic) {
  const double a = 1.0 / conductance;
  return std::copysign(2.0 * std::abs(drop) / (a + std::sqrt(a * a + 4.0 * quadratic * std::abs(drop))), drop);
}

double pump_gap(const TruthSignals& at, const HiddenEffect& e, double, TruthAdditions& out) {
  out.pump_slip_m3_s += orifice_with_transition(at.port_1_Pa - at.port_2_Pa, e.size, e.shape[0]);
  return 0.0;
}

double seal_gap(const TruthSignals& at, const HiddenEffect& e, double, TruthAdditions& out) {
  out.seal_leakage_m3_s += orifice_with_transition(at.chamber_Pa[0] - at.chamber_Pa[1], e.size, e.shape[0]);
  return 0.0;
}

// q = k (p_1 - p_2) exp(-|omega| / omega_k): the film that seals the pump builds up with speed
double pump_film(const TruthSignals& at, const HiddenEffect& e, double, TruthAdditions& out) {
  const double speed = std::hypot(at.shaft_speed, 0.5) - 0.5;
  out.pump_slip_m3_s += e.size * (at.port_1_Pa - at.port_2_Pa) * std::exp(-speed / e.shape[0]);
  return 0.0;
}

// q = k (p_1 - p_2) (|omega| / 100 rad/s)^1.2: oil carried through with the gears
double pump_carry(const TruthSignals& at, const HiddenEffect& e, double, TruthAdditions& out) {
  const double speed = std::hypot(at.shaft_speed, 0.5) / 100.0;
  out.pump_slip_m3_s += e.size * (at.port_1_Pa - at.port_2_Pa) * std::pow(speed, 1.2);
  return 0.0;
}

// q = k omega: each turn delivers less than it sweeps
double pump_carry_back(const TruthSignals& at, const HiddenEffect& e, double, TruthAdditions& out) {
  out.pump_slip_m3_s += e.size * at.shaft_speed;
  return 0.0;
}

// dp = R q (1 + s |q| / q_u): pipe with entrance loss. The size is the drop at q_u.
double line_with_entrance(const TruthSignals&, const HiddenEffect& e, double, TruthAdditions& out) {
  out.line[e.side] = {.laminar = e.size / kUsualFlow_m3_s,
                      .power = e.shape[0] * e.size / (kUsualFlow_m3_s * kUsualFlow_m3_s),
                      .exponent = 2.0};
  return 0.0;
}

// dp = K q |q|^0.75: Blasius' rough law of turbulent pipes. The size is the drop at q_u.
double line_blasius(const TruthSignals&, const HiddenEffect& e, double, TruthAdditions& out) {
  out.line[e.side] = {.laminar = 0.0, .power = e.size / std::pow(kUsualFlow_m3_s, 1.75), .exponent = 1.75};
  return 0.0;
}

// A poppet with two rest positions: it snaps open at 20 kPa, which lowers its cracking pressure by the size, and falls
// back at 20 kPa less 0.4 of the size.
double poppet_relay(const TruthSignals& at, const HiddenEffect& e, double open, TruthAdditions& out) {
  constexpr double kOpen_Pa = 2e4, kWidth_Pa = 4e3, kShare = 0.4;
  const double drop = (e.side == 0 ? at.port_1_Pa : at.port_2_Pa) - at.chamber_Pa[e.side];
  const double threshold = kOpen_Pa - kShare * e.size * open;
  const double wanted = 1.0 / (1.0 + std::exp(-std::clamp((drop - threshold) / kWidth_Pa, -40.0, 40.0)));
  out.cracking_relief_Pa[e.side] += e.size * open;
  return (wanted - open) / e.shape[0];
}

// dV/dp = C (0.15 + 0.85 exp(-p / p_h)): a braid that tightens
double braided_hose(const TruthSignals& at, const HiddenEffect& e, double, TruthAdditions& out) {
  const double pressure = std::max(at.chamber_Pa[e.side], 0.0);
  out.compliance_m3_Pa[e.side] += e.size * (0.15 + 0.85 * std::exp(-pressure / e.shape[0]));
  return 0.0;
}

// Rod seal: laminar gap that turns turbulent; c such that at 10 MPa the quadratic part is `shape` of the laminar one.
double rod_seal(const TruthSignals& at, const HiddenEffect& e, double, TruthAdditions& out) {
  constexpr double kUsual_Pa = 1e7;
  const double quadratic = e.shape[0] / (e.size * e.size * kUsual_Pa);
  out.outflow_m3_s[e.side] += gap_flow(at.chamber_Pa[e.side] - kReservoir_Pa, e.size, quadratic);
  return 0.0;
}

double cracked_fitting(const TruthSignals& at, const HiddenEffect& e, double, TruthAdditions& out) {
  out.outflow_m3_s[e.side] += orifice_with_transition(at.chamber_Pa[e.side] - kReservoir_Pa, e.size, e.shape[0]);
  return 0.0;
}

// Free air, compressed without heat (n = 1.4), of which the share p / p_s has dissolved:
//   volume share a(p) = alpha (1 - p / p_s) (p_a / p)^(1/n),  added softness -da/dp
double air_henry(const TruthSignals& at, const HiddenEffect& e, double, TruthAdditions& out) {
  constexpr double kAtmosphere_Pa = 101325.0, kExponent = 1.4, kLeast_Pa = 2e4;
  const std::array<double, 4> pressures = {at.port_1_Pa, at.port_2_Pa, at.chamber_Pa[0], at.chamber_Pa[1]};
  for (std::size_t k = 0; k < pressures.size(); ++k) {
    const double p = std::max(pressures[k], kLeast_Pa);
    const double squeezed = std::pow(kAtmosphere_Pa / p, 1.0 / kExponent);
    const double dissolved = p / e.shape[0];
    if (dissolved >= 1.0) continue;
    out.softness_1_Pa[k] += e.size * squeezed * ((1.0 - dissolved) / (kExponent * p) + 1.0 / e.shape[0]);
  }
  return 0.0;
}

// Oil that thins as exp(-b T), T warmed by what the motor takes: tau dT/dt = P / 100 W - T
double oil_thinning(const TruthSignals& at, const HiddenEffect& e, double warmth, TruthAdditions& out) {
  const double power = std::max(at.voltage_V * at.current_A, 0.0);
  out.viscosity *= std::exp(-e.size * warmth);
  return (power / 100.0 - warmth) / e.shape[0];
}

constexpr std::array kEffects = {
    EffectForm{.id = "turbulent_pump_slip",
               .form = "transition",
               .element = "pump",
               .unit = "m3/(s Pa^0.5)",
               .barely = 7e-13,
               .largest = 4e-10,
               .shapes = {{{2e4, 2e5}}},
               .strength = "k",
               .act = &pump_gap},
    EffectForm{.id = "turbulent_seal_leakage",
               .form = "transition",
               .element = "piston_seal",
               .unit = "m3/(s Pa^0.5)",
               .barely = 5e-13,
               .largest = 4e-10,
               .shapes = {{{2e4, 2e5}}},
               .strength = "k",
               .act = &seal_gap},
    EffectForm{.id = "speed_dependent_pump_slip",
               .form = "film",
               .element = "pump",
               .unit = "m3/(s Pa)",
               .barely = 3e-16,
               .largest = 2e-13,
               .shapes = {{{15.0, 80.0}}},
               .act = &pump_film},
    EffectForm{.id = "speed_dependent_pump_slip",
               .form = "carry",
               .element = "pump",
               .unit = "m3/(s Pa)",
               .barely = 6e-17,
               .largest = 1e-13,
               .act = &pump_carry},
    EffectForm{.id = "line_resistance",
               .form = "entrance",
               .element = "valve_1",
               .other_element = "valve_2",
               .unit = "Pa",
               .barely = 3e3,
               .largest = 1e6,
               .shapes = {{{0.02, 0.2}}},
               .act = &line_with_entrance},
    EffectForm{.id = "line_resistance",
               .form = "blasius",
               .element = "valve_1",
               .other_element = "valve_2",
               .unit = "Pa",
               .barely = 3e3,
               .largest = 1e6,
               .act = &line_blasius},
    EffectForm{.id = "valve_hysteresis",
               .form = "relay",
               .element = "valve_1",
               .other_element = "valve_2",
               .unit = "Pa",
               .barely = 3e3,
               .largest = 4.5e4,
               .shapes = {{{0.03, 0.3}}},
               .has_memory = true,
               .act = &poppet_relay},
    EffectForm{.id = "hose_compliance",
               .form = "braided",
               .element = "chamber_a",
               .other_element = "chamber_b",
               .unit = "m3/Pa",
               .barely = 2e-15,
               .largest = 5e-13,
               .shapes = {{{4e6, 2e7}}},
               .act = &braided_hose},
    EffectForm{.id = "external_leakage",
               .form = "rod_seal",
               .element = "chamber_a",
               .other_element = "chamber_b",
               .unit = "m3/(s Pa)",
               .barely = 5e-18,
               .largest = 3e-13,
               .shapes = {{{0.02, 0.2}}},
               .act = &rod_seal},
    EffectForm{.id = "external_leakage",
               .form = "fitting",
               .element = "chamber_a",
               .other_element = "chamber_b",
               .unit = "m3/(s Pa^0.5)",
               .barely = 5e-15,
               .largest = 5e-10,
               .shapes = {{{2e4, 2e5}}},
               .act = &cracked_fitting},
    EffectForm{.id = "entrained_air",
               .form = "henry",
               .element = "fluid",
               .unit = "1",
               .barely = 2e-4,
               .largest = 0.03,
               .shapes = {{{1.5e7, 5e7}}},
               .act = &air_henry},
    EffectForm{.id = "viscosity_warm_up",
               .form = "exponential",
               .element = "fluid",
               .unit = "1",
               .barely = 3e-3,
               .largest = 0.6,
               .shapes = {{{8.0, 80.0}}},
               .has_memory = true,
               .cold_start = true,
               .act = &oil_thinning},
};

constexpr std::array kTwins = {EffectForm{.id = "speed_dependent_pump_slip",
                                          .form = "carry_back",
                                          .element = "pump",
                                          .unit = "m3/rad",
                                          .barely = 4e-12,
                                          .largest = 4e-9,
                                          .strength = "k_d",
                                          .act = &pump_carry_back}};

}  // namespace

std::span<const EffectForm> hydraulic_effects() { return kEffects; }
std::span<const EffectForm> twin_effects() { return kTwins; }

}  // namespace sealwatch::bench

// Forces on the piston and rod, against +x. [N]
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "services/verification/truth/effects.hpp"

namespace sealwatch::bench {
namespace {

constexpr double kReservoir_Pa = 1.0e6;

double positive(double a, double width) { return 0.5 * (a + std::sqrt(a * a + width * width)); }

// F = F_c (2/pi) atan(v / w)
double coulomb_arctangent(const TruthSignals& at, const HiddenEffect& e, double, TruthAdditions& out) {
  out.piston_force_N += e.size * arctangent_sign(at.speed_m_s, e.shape[0]);
  return 0.0;
}

double coulomb_clamped(const TruthSignals& at, const HiddenEffect& e, double, TruthAdditions& out) {
  out.piston_force_N += e.size * clamped_sign(at.speed_m_s, e.shape[0]);
  return 0.0;
}

// F = F_c (1 + r / (1 + (v / v_st)^2)) v / sqrt(v^2 + w^2): Hess and Soom's curve
double stribeck_lorentz(const TruthSignals& at, const HiddenEffect& e, double, TruthAdditions& out) {
  const auto& [ratio, film_speed, width] = e.shape;
  const double slow = at.speed_m_s / film_speed;
  out.piston_force_N += e.size * (1.0 + ratio / (1.0 + slow * slow)) * algebraic_sign(at.speed_m_s, width);
  return 0.0;
}

// F = k ((p_A - p_0)+ + (p_B - p_0)+) v / sqrt(v^2 + w^2): two lip seals, each pressed on by its chamber
double lip_seals(const TruthSignals& at, const HiddenEffect& e, double, TruthAdditions& out) {
  const double pressed =
      positive(at.chamber_Pa[0] - kReservoir_Pa, 1e4) + positive(at.chamber_Pa[1] - kReservoir_Pa, 1e4);
  out.piston_force_N += e.size * pressed * algebraic_sign(at.speed_m_s, e.shape[0]);
  return 0.0;
}

// F = F_c s, delta ds/dt = v - |v| s |s|: Bouc and Wen's hysteresis of exponent 2
double bristles_bouc_wen(const TruthSignals& at, const HiddenEffect& e, double s, TruthAdditions& out) {
  out.piston_force_N += e.size * s;
  return (at.speed_m_s - std::abs(at.speed_m_s) * s * std::abs(s)) / e.shape[0];
}

// LuGre: delta ds/dt = v - |v| s / g, g = 1 + 0.3 exp(-|v| / v_g), F = F_c (s + c delta ds/dt)
double bristles_lugre(const TruthSignals& at, const HiddenEffect& e, double s, TruthAdditions& out) {
  constexpr double kBreakaway = 0.3, kFilm_m_s = 3e-4, kDamping_s_m = 100.0;
  const double v = at.speed_m_s;
  const double deflection_rate = v - std::abs(v) * s / (1.0 + kBreakaway * std::exp(-std::abs(v) / kFilm_m_s));
  out.piston_force_N += e.size * (s + kDamping_s_m * deflection_rate);
  return deflection_rate / e.shape[0];
}

// F = k v sqrt(v^2 + v_0^2): viscous at first, then quadratic
double drag_transition(const TruthSignals& at, const HiddenEffect& e, double, TruthAdditions& out) {
  out.piston_force_N += e.size * at.speed_m_s * std::hypot(at.speed_m_s, e.shape[0]);
  return 0.0;
}

// F = k x (1 + h (x / 80 mm)^2): a coil spring that hardens
double spring_hardening(const TruthSignals& at, const HiddenEffect& e, double, TruthAdditions& out) {
  constexpr double kStroke_m = 0.080;
  const double share = at.position_m / kStroke_m;
  out.piston_force_N += e.size * at.position_m * (1.0 + e.shape[0] * share * share);
  return 0.0;
}

// F = F_b (1 + cos(pi (x - x_b) / w)) / 2 within w of x_b
double load_raised_cosine(const TruthSignals& at, const HiddenEffect& e, double, TruthAdditions& out) {
  const double away = std::min(std::abs(at.position_m - e.shape[0]) / e.shape[1], 1.0);
  out.piston_force_N += e.size * 0.5 * (1.0 + std::cos(std::numbers::pi * away));
  return 0.0;
}

// A gate's load by position, as read off a curve: cubic Hermite through points, flat tangents
double load_table(const TruthSignals& at, const HiddenEffect& e, double, TruthAdditions& out) {
  static constexpr std::array<double, 8> kPosition_m = {0.0, 0.030, 0.040, 0.047, 0.053, 0.060, 0.070, 0.080};
  static constexpr std::array<double, 8> kLoad = {0.0, 0.05, 0.2, 0.7, 1.0, 0.85, 0.8, 0.8};
  const double x = std::clamp(at.position_m, kPosition_m.front(), kPosition_m.back());
  std::size_t k = 0;
  while (k + 2 < kPosition_m.size() && x > kPosition_m[k + 1]) ++k;
  const double share = (x - kPosition_m[k]) / (kPosition_m[k + 1] - kPosition_m[k]);
  out.piston_force_N += e.size * (kLoad[k] + (kLoad[k + 1] - kLoad[k]) * share * share * (3.0 - 2.0 * share));
  return 0.0;
}

// F = F_h s, x_y ds/dt = v - 0.6 |v| s |s| - 0.4 v s^2: Bouc and Wen of exponent 2 over millimetres
double packing(const TruthSignals& at, const HiddenEffect& e, double s, TruthAdditions& out) {
  const double v = at.speed_m_s;
  out.piston_force_N += e.size * s;
  return (v - 0.6 * std::abs(v) * s * std::abs(s) - 0.4 * v * s * s) / e.shape[0];
}

// Clearance between stem and load: g from 0 (one flank) to 1 (the other); between the flanks F_b of the load is gone.
double clearance(const TruthSignals& at, const HiddenEffect& e, double g, TruthAdditions& out) {
  constexpr double kFlank = 0.06, kSoftEnd = 0.02;
  const double inside = std::clamp(g, 0.0, 1.0);
  out.piston_force_N -= e.size * (1.0 - std::exp(-inside / kFlank)) * (1.0 - std::exp(-(1.0 - inside) / kFlank));
  const double way_left = at.speed_m_s > 0.0 ? inside : 1.0 - inside;
  return -at.speed_m_s / e.shape[0] * way_left / (way_left + kSoftEnd);
}

constexpr forecast::Range kWidth_m_s{3e-5, 1.5e-4};

constexpr std::array kEffects = {
    EffectForm{.id = "coulomb_friction",
               .form = "arctangent",
               .element = "piston",
               .unit = "N",
               .barely = 10.0,
               .largest = 1.5e4,
               .shapes = {kWidth_m_s},
               .strength = "F_c",
               .act = &coulomb_arctangent},
    EffectForm{.id = "coulomb_friction",
               .form = "clamped",
               .element = "piston",
               .unit = "N",
               .barely = 10.0,
               .largest = 1.5e4,
               .shapes = {kWidth_m_s},
               .strength = "F_c",
               .act = &coulomb_clamped},
    EffectForm{.id = "stribeck_friction",
               .form = "lorentz",
               .element = "piston",
               .unit = "N",
               .barely = 10.0,
               .largest = 1e4,
               .shapes = {{{0.5, 2.0}, {2e-4, 8e-4}, kWidth_m_s}},
               .act = &stribeck_lorentz},
    EffectForm{.id = "pressure_dependent_friction",
               .form = "lip_seals",
               .element = "piston",
               .unit = "m2",
               .barely = 6e-7,
               .largest = 1e-3,
               .shapes = {kWidth_m_s},
               .act = &lip_seals},
    EffectForm{.id = "presliding_friction",
               .form = "bouc_wen",
               .element = "piston",
               .unit = "N",
               .barely = 8.0,
               .largest = 1e4,
               .shapes = {{{1e-5, 1.5e-4}}},
               .strength = "F_c",
               .has_memory = true,
               .act = &bristles_bouc_wen},
    EffectForm{.id = "presliding_friction",
               .form = "lugre_stribeck",
               .element = "piston",
               .unit = "N",
               .barely = 8.0,
               .largest = 1e4,
               .shapes = {{{1e-5, 1.5e-4}}},
               .strength = "F_c",
               .has_memory = true,
               .act = &bristles_lugre},
    EffectForm{.id = "quadratic_drag",
               .form = "transition",
               .element = "piston",
               .unit = "N s2/m2",
               .barely = 1e7,
               .largest = 5e9,
               .shapes = {{{1e-4, 3e-4}}},
               .strength = "k",
               .act = &drag_transition},
    EffectForm{.id = "spring_load",
               .form = "hardening",
               .element = "piston",
               .unit = "N/m",
               .barely = 400.0,
               .largest = 5e5,
               .shapes = {{{0.02, 0.15}}},
               .act = &spring_hardening},
    EffectForm{.id = "position_dependent_load",
               .form = "raised_cosine",
               .element = "piston",
               .unit = "N",
               .barely = 5.0,
               .largest = 2e4,
               .shapes = {{{0.046, 0.056}, {3e-3, 1e-2}}},
               .act = &load_raised_cosine},
    EffectForm{.id = "position_dependent_load",
               .form = "table",
               .element = "piston",
               .unit = "N",
               .barely = 5.0,
               .largest = 2e4,
               .act = &load_table},
    EffectForm{.id = "hysteretic_load",
               .form = "bouc_wen_2",
               .element = "piston",
               .unit = "N",
               .barely = 5.0,
               .largest = 1e4,
               .shapes = {{{5e-4, 4e-3}}},
               .has_memory = true,
               .act = &packing},
    EffectForm{.id = "backlash",
               .form = "clearance",
               .element = "piston",
               .unit = "N",
               .barely = 20.0,
               .largest = 3e4,
               .shapes = {{{8e-5, 5e-4}}},
               .strength = "F_b",
               .has_memory = true,
               .act = &clearance},
};

}  // namespace

double arctangent_sign(double v, double w) { return 2.0 * std::numbers::inv_pi * std::atan(v / w); }
double algebraic_sign(double v, double w) { return v / std::hypot(v, w); }
double clamped_sign(double v, double w) {
  const double u = std::clamp(v / w, -1.0, 1.0);
  return 0.5 * u * (3.0 - u * u);
}

std::span<const EffectForm> piston_effects() { return kEffects; }

}  // namespace sealwatch::bench

// Physics that the catalogue has no name for.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "services/verification/truth/effects.hpp"

namespace sealwatch::bench {
namespace {

// A bent spindle: F = F_t sin(2 pi x / s)
double bent_spindle(const TruthSignals& at, const HiddenEffect& e, double, TruthAdditions& out) {
  out.piston_force_N += e.size * std::sin(2.0 * std::numbers::pi * at.position_m / e.shape[0]);
  return 0.0;
}

// Dry friction around one position alone
double scored_bore(const TruthSignals& at, const HiddenEffect& e, double, TruthAdditions& out) {
  const double away = std::min(std::abs(at.position_m - e.shape[0]) / e.shape[1], 1.0);
  const double here = 0.5 * (1.0 + std::cos(std::numbers::pi * away));
  out.piston_force_N += e.size * here * algebraic_sign(at.speed_m_s, e.shape[2]);
  return 0.0;
}

// A wiper lip that drags when the rod comes out and glides when it goes in
double one_way_lip(const TruthSignals& at, const HiddenEffect& e, double, TruthAdditions& out) {
  out.piston_force_N += e.size * std::max(arctangent_sign(at.speed_m_s, e.shape[0]), 0.0);
  return 0.0;
}

// Seal that lifts off above a pressure: q = G (dp - p_t)+
double seal_blow_by(const TruthSignals& at, const HiddenEffect& e, double, TruthAdditions& out) {
  const double above = at.chamber_Pa[0] - at.chamber_Pa[1] - e.shape[0];
  out.seal_leakage_m3_s += e.size * 0.5 * (above + std::hypot(above, 5e4));
  return 0.0;
}

// Seal leakage around a worn place of the liner
double worn_liner(const TruthSignals& at, const HiddenEffect& e, double, TruthAdditions& out) {
  const double away = std::min(std::abs(at.position_m - e.shape[0]) / e.shape[1], 1.0);
  out.seal_leakage_m3_s +=
      e.size * (at.chamber_Pa[0] - at.chamber_Pa[1]) * 0.5 * (1.0 + std::cos(std::numbers::pi * away));
  return 0.0;
}

// Churning oil: T = T_w (omega / 200 rad/s)^3
double churning(const TruthSignals& at, const HiddenEffect& e, double, TruthAdditions& out) {
  out.shaft_torque_Nm += e.size * std::pow(at.shaft_speed / 200.0, 3);
  return 0.0;
}

// Load that comes as the test goes on: F = F_0 (1 - exp(-t / tau))
double creeping_load(const TruthSignals& at, const HiddenEffect& e, double, TruthAdditions& out) {
  out.piston_force_N += e.size * (1.0 - std::exp(-std::max(at.time_s, 0.0) / e.shape[0]));
  return 0.0;
}

constexpr std::array kEffects = {
    EffectForm{.id = "unlisted",
               .form = "bent_spindle",
               .element = "piston",
               .unit = "N",
               .barely = 5.0,
               .largest = 1e4,
               .shapes = {{{3e-3, 8e-3}}},
               .act = &bent_spindle},
    EffectForm{.id = "unlisted",
               .form = "scored_bore",
               .element = "piston",
               .unit = "N",
               .barely = 10.0,
               .largest = 1e4,
               .shapes = {{{0.047, 0.056}, {2e-3, 6e-3}, {3e-5, 1.5e-4}}},
               .act = &scored_bore},
    EffectForm{.id = "unlisted",
               .form = "one_way_lip",
               .element = "piston",
               .unit = "N",
               .barely = 10.0,
               .largest = 1e4,
               .shapes = {{{3e-5, 1.5e-4}}},
               .act = &one_way_lip},
    EffectForm{.id = "unlisted",
               .form = "seal_blow_by",
               .element = "piston_seal",
               .unit = "m3/(s Pa)",
               .barely = 3e-15,
               .largest = 1e-12,
               .shapes = {{{9e6, 1.05e7}}},
               .act = &seal_blow_by},
    EffectForm{.id = "unlisted",
               .form = "worn_liner",
               .element = "piston_seal",
               .unit = "m3/(s Pa)",
               .barely = 3e-16,
               .largest = 2e-13,
               .shapes = {{{0.046, 0.056}, {3e-3, 8e-3}}},
               .act = &worn_liner},
    EffectForm{.id = "unlisted",
               .form = "churning",
               .element = "shaft",
               .unit = "N m",
               .barely = 6e-4,
               .largest = 0.2,
               .act = &churning},
    EffectForm{.id = "unlisted",
               .form = "creeping_load",
               .element = "piston",
               .unit = "N",
               .barely = 8.0,
               .largest = 1e4,
               .shapes = {{{5.0, 20.0}}},
               .act = &creeping_load},
};

}  // namespace

std::span<const EffectForm> unlisted_effects() { return kEffects; }

}  // namespace sealwatch::bench

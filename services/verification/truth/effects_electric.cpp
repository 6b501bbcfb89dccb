// Driver, winding, shaft.
#include <array>
#include <cmath>

#include "services/verification/truth/effects.hpp"

namespace sealwatch::bench {
namespace {

// V = V_d (2/pi) atan(i / w): each switching loses the dead time's share
double bridge_loss(const TruthSignals& at, const HiddenEffect& e, double, TruthAdditions& out) {
  out.driver_loss_V += e.size * arctangent_sign(at.current_A, e.shape[0]);
  return 0.0;
}

// Pade's all-pass of order 1 for the delay T: the command arrives as 2 m - u, (T / 2) dm/dt = u - m
double bridge_delay(const TruthSignals& at, const HiddenEffect& e, double memory, TruthAdditions& out) {
  out.driver_loss_V += 2.0 * (at.command_V - memory);
  return 2.0 * (at.command_V - memory) / e.size;
}

// R = R_M (1 + 0.0039 T): tau dT/dt = r i^2 (1 + 0.0039 T) - T, r the size [K/A2]
double copper_heating(const TruthSignals& at, const HiddenEffect& e, double warmer_K, TruthAdditions& out) {
  constexpr double kCopper_1_K = 0.0039;
  out.winding_loss_V += at.winding_resistance_ohm * kCopper_1_K * warmer_K * at.current_A;
  return (e.size * at.current_A * at.current_A * (1.0 + kCopper_1_K * warmer_K) - warmer_K) / e.shape[0];
}

double bearing_friction(const TruthSignals& at, const HiddenEffect& e, double, TruthAdditions& out) {
  out.shaft_torque_Nm += e.size * arctangent_sign(at.shaft_speed, e.shape[0]);
  return 0.0;
}

// T = k sqrt(dp^2 + (0.1 MPa)^2) omega / sqrt(omega^2 + w^2): gears pressed against their plates
double plate_friction(const TruthSignals& at, const HiddenEffect& e, double, TruthAdditions& out) {
  const double pressed = std::hypot(at.port_1_Pa - at.port_2_Pa, 1e5);
  out.shaft_torque_Nm += e.size * pressed * algebraic_sign(at.shaft_speed, e.shape[0]);
  return 0.0;
}

// T = A (sin N theta + 0.2 sin 2 N theta), N = 6
double cogging(const TruthSignals& at, const HiddenEffect& e, double angle, TruthAdditions& out) {
  constexpr double kTeeth = 6.0;
  out.shaft_torque_Nm += e.size * (std::sin(kTeeth * angle) + 0.2 * std::sin(2.0 * kTeeth * angle));
  return at.shaft_speed;
}

// T = k (i - i_s atan(i / i_s)): iron that saturates
double iron_saturation(const TruthSignals& at, const HiddenEffect& e, double, TruthAdditions& out) {
  out.shaft_torque_Nm += e.size * (at.current_A - e.shape[0] * std::atan(at.current_A / e.shape[0]));
  return 0.0;
}

constexpr std::array kEffects = {
    EffectForm{.id = "driver_dead_time",
               .form = "bridge_loss",
               .element = "driver",
               .unit = "V",
               .barely = 6e-3,
               .largest = 4.0,
               .shapes = {{{0.1, 0.6}}},
               .strength = "V_d",
               .act = &bridge_loss},
    EffectForm{.id = "driver_dead_time",
               .form = "delay",
               .element = "driver",
               .unit = "s",
               .barely = 1.2e-4,
               .largest = 0.02,
               .strength = "tau_d",
               .has_memory = true,
               .memory_size = 10.0,
               .act = &bridge_delay},
    EffectForm{.id = "winding_heating",
               .form = "copper",
               .element = "winding",
               .unit = "K/A2",
               .barely = 0.2,
               .largest = 20.0,
               .shapes = {{{10.0, 120.0}}},
               .has_memory = true,
               .memory_size = 10.0,
               .cold_start = true,
               .act = &copper_heating},
    EffectForm{.id = "shaft_coulomb_friction",
               .form = "arctangent",
               .element = "shaft",
               .unit = "N m",
               .barely = 4e-4,
               .largest = 0.15,
               .shapes = {{{0.5, 5.0}}},
               .strength = "T_c",
               .act = &bearing_friction},
    EffectForm{.id = "pressure_dependent_shaft_friction",
               .form = "plates",
               .element = "shaft",
               .unit = "m3/rad",
               .barely = 3e-11,
               .largest = 8e-9,
               .shapes = {{{0.5, 5.0}}},
               .strength = "k",
               .act = &plate_friction},
    EffectForm{.id = "cogging_torque",
               .form = "two_harmonics",
               .element = "shaft",
               .unit = "N m",
               .barely = 8e-4,
               .largest = 0.15,
               .strength = "A",
               .has_memory = true,
               .memory_size = 100.0,
               .act = &cogging},
    EffectForm{.id = "torque_saturation",
               .form = "arctangent",
               .element = "shaft",
               .unit = "N m/A",
               .barely = 8e-4,
               .largest = 0.15,
               .shapes = {{{2.5, 8.0}}},
               .act = &iron_saturation},
};

}  // namespace

std::span<const EffectForm> electric_effects() { return kEffects; }

}  // namespace sealwatch::bench

// Hidden physics of blind trials: what the bench has and the reference model lacks.
//
// Each form belongs to a physics id of the interface, but is written differently from the catalogue that it is looked
// for with: arctangent or algebraic instead of tanh, Bouc-Wen of exponent 2 instead of Dahl, isentropic air that
// dissolves, resistances that are solved for instead of lagged, tables. Forms of id "unlisted" have no counterpart.
//
// Signs: losses are positive, as in the balances of truth_plant.hpp.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "sealwatch/forecast/degradation.hpp"

namespace sealwatch::bench {

/// What hidden physics sees.
struct TruthSignals {
  double time_s = 0.0;  ///< since the start of the recording; negative while the circuit settles
  double command_V = 0.0, voltage_V = 0.0, current_A = 0.0, shaft_speed = 0.0;
  double port_1_Pa = 0.0, port_2_Pa = 0.0;
  std::array<double, 2> chamber_Pa{};  ///< a, b
  double speed_m_s = 0.0, position_m = 0.0;
  double winding_resistance_ohm = 0.0;
};

/// Pressure that a line takes at the flow q: laminar q + power q |q|^(exponent - 1).
struct LineLoss {
  double laminar = 0.0, power = 0.0, exponent = 1.0;
  [[nodiscard]] bool any() const { return laminar != 0.0 || power != 0.0; }
};

/// What hidden physics adds to the balances.
struct TruthAdditions {
  double driver_loss_V = 0.0, winding_loss_V = 0.0, shaft_torque_Nm = 0.0;
  double pump_slip_m3_s = 0.0;     ///< from port 1 to port 2
  std::array<LineLoss, 2> line{};  ///< valve_1, valve_2
  std::array<double, 2> cracking_relief_Pa{};
  std::array<double, 2> outflow_m3_s{};      ///< chamber a, b to the reservoir
  std::array<double, 2> compliance_m3_Pa{};  ///< chamber a, b
  double seal_leakage_m3_s = 0.0;            ///< from a to b
  double piston_force_N = 0.0;               ///< against +x
  std::array<double, 4> softness_1_Pa{};     ///< added to 1/beta in port 1, port 2, chamber a, chamber b
  double viscosity = 1.0;                    ///< relative
};

inline constexpr std::size_t kShapes = 3;

/// One form of hidden physics at one place with its numbers.
struct HiddenEffect {
  const struct EffectForm* form = nullptr;
  std::string element;
  std::size_t side = 0;  ///< 0: a, 1; 1: b, 2
  double size = 0.0;     ///< in the form's unit
  std::array<double, kShapes> shape{};
};

struct EffectForm {
  std::string_view id;       ///< of the interface, or "unlisted"
  std::string_view form;     ///< this form's own name
  std::string_view element;  ///< or the first of two
  std::string_view other_element = {};
  std::string_view unit;  ///< of the size
  /// A size that tests of half a minute under several loads begin to show, and one beyond which no actuator would go.
  double barely = 0.0, largest = 0.0;
  std::array<forecast::Range, kShapes> shapes{};  ///< drawn log-uniformly
  /// The catalogue's strength that means the same, and what the size is multiplied by; empty: none does.
  std::string_view strength = {};
  double strength_factor = 1.0;
  bool has_memory = false;
  double memory_size = 1.0;  ///< usual size of the hidden state
  bool cold_start = false;   ///< the hidden state is 0 when the recording starts, whatever went before
  /// Adds what the effect does to `out` and returns d memory / dt.
  double (*act)(const TruthSignals& at, const HiddenEffect& effect, double memory, TruthAdditions& out) = nullptr;
};

[[nodiscard]] std::span<const EffectForm> piston_effects();
[[nodiscard]] std::span<const EffectForm> hydraulic_effects();
[[nodiscard]] std::span<const EffectForm> electric_effects();
[[nodiscard]] std::span<const EffectForm> unlisted_effects();
/// What only inseparable pairs hide.
[[nodiscard]] std::span<const EffectForm> twin_effects();

/// Sign functions of dry friction, rounded over the width w.
[[nodiscard]] double arctangent_sign(double v, double w);
[[nodiscard]] double algebraic_sign(double v, double w);
[[nodiscard]] double clamped_sign(double v, double w);  ///< as Karnopp's, its corner cubic: exactly +-1 beyond w

}  // namespace sealwatch::bench

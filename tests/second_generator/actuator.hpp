// The electro-hydrostatic actuator of the reference model, from its written equations alone, and the physics that may
// hide in it. SI units; forces oppose +x, torques +omega, flows leave a chamber or pass from port 1 to 2 or from
// chamber A to B.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "tests/second_generator/radau.hpp"

namespace second_generator {

enum Name {
  R_M,
  C_M,
  L_M,
  Omega_M,
  T_M,
  J_M,
  f_M,
  d_P,
  alpha_P,
  R_PL,
  c_D,
  a_V,
  k_V,
  g_V,
  R_CL,
  A_C,
  x_C,
  m_C,
  f_C,
  phi,
  V_0,
  V_P,
  beta,
  rho,
  p_0,
  K_MU,
  p_crack,
  r_pilot,
  kNames
};
using Values = std::array<double, kNames>;

struct Parameter {
  const char* name;
  double nominal;
  bool free;  // estimated from the recordings: the datasheet gives a guess
};
extern const std::array<Parameter, kNames> kParameters;

enum State { kZ, kI, kOmega, kP1, kP2, kPa, kPb, kV, kX, kFlowSeen, kPaSeen, kPbSeen, kXSeen, kVSeen, kStates };

// A sensor: what it shows, its noise (standard deviation) and its usual size, both in the channel's unit.
struct Channel {
  const char* name;
  const char* unit;
  State state;
  double noise, usual;
};
extern const std::array<Channel, 7> kChannels;

// What can hide. The comment gives the term; s is its strength, a and b are its shape.
enum class Form {
  // near to a law of the catalogue
  arctangent_friction,     // s (2/pi) atan(v / a)
  exponential_stribeck,    // s (1 + b exp(-|v| / 0.3 mm/s)) r(v, a), r(v, a) = v / sqrt(v^2 + a^2)
  friction_by_difference,  // s |p_A - p_B| r(v, a)
  friction_by_sum,         // s (p_A + p_B) r(v, a)
  lugre,                   // (s / a) z, dz/dt = v - |v| z / (a (1 + 0.2 exp(-(v / 0.2 mm/s)^2)))
  rounded_quadratic_drag,  // s v sqrt(v^2 + a^2)
  softening_spring,        // s x (1 - a x / x_C)
  cosine_bump,             // s cos^2(pi (x - a) / (4 b)), within 2 b of a
  polynomial_step,         // s (3 t^2 - 2 t^3), t from 0 to 1 within b of a
  bouc_wen,                // s z, dz/dt = v (1 - |z|^2 (1 + sign(v z)) / 2) / a
  trapezoidal_backlash,    // -s within a clearance a that the piston crosses
  blended_seal_leakage,    // s D / (D^2 + a^2)^(1/4)
  blended_pump_slip,       // s D / (D^2 + a^2)^(1/4)
  drag_slip,               // s omega
  rounded_filling_slip,    // s omega sqrt(omega^2 + a^2)
  rounded_rising_slip,     // s sqrt(omega^2 + a^2) (p_1 - p_2)
  laminar_line,            // drop s q, without delay
  turbulent_line,          // drop s q |q|, without delay
  flow_held_poppet,        // the cracking pressure falls by s z, 20 ms dz/dt = (1 + tanh(q / a)) / 2 - z
  thinning_leak,           // s (p - p_0) (1 + (p - p_0) / a)
  blended_leak,            // s (p - p_0) / ((p - p_0)^2 + a^2)^(1/4)
  exponential_hose,        // compliance s exp(-p / a)
  mixture_air,             // s: air's share of the volume at 1 atm; mixture of both volumes, polytropic with a
  exponential_warm_up,     // viscosity times exp(-s z), a dz/dt = 1 - z
  rounded_shaft_friction,  // s r(omega, a)
  shaft_friction_by_load,  // s |p_1 - p_2| r(omega, a)
  cogging_with_harmonic,   // s (sin(a theta) + 0.15 sin(2 a theta + 1))
  tanh_saturation,         // T_M (i - j tanh(i / j)), s = T_M / (3 j^2)
  rounded_voltage_loss,    // s r(i, a)
  rounded_dead_zone,       // s r(u, a)
  self_heating,            // s z i, a dz/dt = i^2 (1 + s z / R_M) - z
  // far from the catalogue, or with corners
  karnopp,                 // s where the piston moves faster than 1 um/s, up to b s where it rests
  direction_friction,      // s where v > 0.02 mm/s, a s the other way, straight in between
  root_drag,               // s sign(v) sqrt(|v|)
  cubic_spring,            // s (x - a)^3
  triangular_bump,         // s max(0, 1 - |x - a| / b)
  scratched_bore,          // s (p_A - p_B) where |x - a| < b, with edges 0.2 mm wide
  relief_leak,             // s max(0, p - a)
  hard_dead_zone,          // u loses s, but never changes sign
  hard_knee,               // s max(0, |i| - a) sign(i)
  tooth_ripple,            // s omega cos(a theta)
  reynolds_orifice,        // c_D (1 - s exp(-|q| / a))
  speed_limited_delivery,  // s max(0, |omega| - a) sign(omega)
  // of the recording and its sensors
  bias,
  gain,
  lag,
  drift,
  input_gain,
  input_bias,
  input_delay,
  clock_rate,
  // of the datasheet and of time
  wrong_value,
  changing_value
};

// A kind of effect: what it is called, where it sits, how large it usually is.
struct Kind {
  Form form;
  const char* element;    // as reports name it
  const char* law;        // the catalogue's id, or "none of the catalogue"
  const char* also;       // other ids that describe it as well, separated by blanks
  const char* parameter;  // the catalogue's name of the strength; empty: not comparable
  const char* unit;
  double significant;  // strength from which an engineer would care
  double largest;      // times that
  double a_low, a_high, b_low, b_high;
  int states;
};

struct Effect {
  Kind kind;
  double strength = 0.0, a = 0.0, b = 0.0;
  std::string note;  // name of the wrong or changing value
  int state = -1;
  int channel = -1;  // of a sensor's fault: index in kChannels
};

class Actuator {
 public:
  Actuator(const Values& values, std::vector<Effect> effects);

  int states() const { return states_; }
  Vector tolerances() const;
  // At rest at x: chamber B at p_b, the load carried by chamber A.
  Vector resting(double x, double p_b) const;
  void rates(double voltage, const Vector& y, Vector& dy) const;
  // Nothing is warm when a test begins.
  void cool(Vector& y) const;
  const std::vector<Effect>& effects() const { return effects_; }

 private:
  struct Terms;
  void add(const Effect& e, const Vector& y, Terms& t, Vector& dy) const;
  void add_force(const Effect& e, const Vector& y, Terms& t, Vector& dy) const;
  void add_flow(const Effect& e, const Vector& y, Terms& t, Vector& dy) const;
  void add_electric(const Effect& e, const Vector& y, Terms& t, Vector& dy) const;
  double valve_flow(int side, double port, double chamber, double other, const Terms& t) const;
  double orifice(int side, double drop, double chamber, double other, const Terms& t) const;
  double inverse_modulus(double pressure, const Terms& t) const;

  Values p_;
  std::vector<Effect> effects_;
  int states_ = kStates;
};

}  // namespace second_generator

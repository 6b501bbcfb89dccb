#include "tests/second_generator/actuator.hpp"

#include <numbers>
#include <string_view>

namespace second_generator {

const std::array<Parameter, kNames> kParameters = {{
    {"R_M", 0.5, true},          {"C_M", 4e-3, false},   {"L_M", 1.5e-3, false},  {"Omega_M", 0.2, false},
    {"T_M", 0.2, false},         {"J_M", 4e-4, false},   {"f_M", 8e-4, true},     {"d_P", 2e-4, false},
    {"alpha_P", 3.98e-8, false}, {"R_PL", 5e13, true},   {"c_D", 0.6, false},     {"a_V", 5e-6, false},
    {"k_V", 2e-5, false},        {"g_V", 5e-7, false},   {"R_CL", 2.6e13, true},  {"A_C", 5.89e-3, false},
    {"x_C", 0.080, false},       {"m_C", 50.0, false},   {"f_C", 2e6, true},      {"phi", 6e4, true},
    {"V_0", 5e-5, false},        {"V_P", 2e-5, false},   {"beta", 1.2e9, true},   {"rho", 870.0, false},
    {"p_0", 1e6, false},         {"K_MU", 1e-11, false}, {"p_crack", 5e4, false}, {"r_pilot", 3.0, false},
}};

const std::array<Channel, 7> kChannels = {{
    {"motor_current", "A", kI, 0.02, 2.5},
    {"shaft_speed", "rad/s", kOmega, 0.5, 200.0},
    {"pressure_a", "Pa", kPaSeen, 1e4, 1e7},
    {"pressure_b", "Pa", kPbSeen, 1e4, 3e6},
    {"flow", "m3/s", kFlowSeen, 4e-8, 8e-6},
    {"position", "m", kXSeen, 5e-6, 0.06},
    {"velocity", "m/s", kVSeen, 1e-5, 1.3e-3},
}};

static double rounded_sign(double v, double width) { return v / std::sqrt(v * v + width * width); }
static double blended_root(double d, double width) { return d / std::sqrt(std::sqrt(d * d + width * width)); }
static double sign_of(double v) { return v > 0.0 ? 1.0 : (v < 0.0 ? -1.0 : 0.0); }

// What the effects add to the balances.
struct Actuator::Terms {
  double force = 0.0, torque = 0.0, seal = 0.0, slip = 0.0, winding = 0.0, command = 0.0, viscosity = 1.0;
  double voltage = 0.0;
  std::array<double, 2> leak{}, compliance{}, line{}, line_square{}, crack{}, orifice_loss{};
  std::array<double, 2> orifice_flow{1.0, 1.0};
  double air = 0.0, air_exponent = 1.0;
  double stick = 0.0, slide = 0.0;  // Karnopp's two forces
};

Actuator::Actuator(const Values& values, std::vector<Effect> effects) : p_(values), effects_(std::move(effects)) {
  for (auto& e : effects_) {
    if (e.kind.states == 0) continue;
    e.state = states_;
    states_ += e.kind.states;
  }
}

Vector Actuator::tolerances() const {
  Vector scale = {1e-5, 1e-5, 1e-3, 20.0, 20.0, 20.0, 20.0, 1e-9, 1e-9, 1e-11, 20.0, 20.0, 1e-9, 1e-9};
  scale.resize(std::size_t(states_), 1e-7);
  for (const auto& e : effects_) {  // a shaft's angle counts in radians, a clearance in metres
    if (e.state < 0) continue;
    if (e.kind.form == Form::trapezoidal_backlash || e.kind.form == Form::lugre) scale[e.state] = 1e-9;
    if (e.kind.form == Form::cogging_with_harmonic || e.kind.form == Form::tooth_ripple) scale[e.state] = 1e-5;
    if (e.kind.form == Form::lag) scale[e.state] = 1e-3 * kChannels[e.channel].noise;
  }
  return scale;
}

Vector Actuator::resting(double x, double p_b) const {
  Vector y(std::size_t(states_), 0.0);
  const double p_a = p_b + p_[phi] / p_[A_C];
  y[kPa] = y[kPaSeen] = y[kP1] = p_a;
  y[kPb] = y[kPbSeen] = p_b;
  y[kP2] = p_[p_0];
  y[kX] = y[kXSeen] = x;
  return y;
}

void Actuator::cool(Vector& y) const {
  for (const auto& e : effects_)
    if (e.kind.form == Form::exponential_warm_up || e.kind.form == Form::self_heating) y[e.state] = 0.0;
}

double Actuator::inverse_modulus(double pressure, const Terms& t) const {
  if (t.air == 0.0) return 1.0 / p_[beta];
  const double absolute = std::max(pressure, 2e4);
  const double volume = t.air * std::pow(101325.0 / absolute, 1.0 / t.air_exponent);
  return (volume / (t.air_exponent * absolute) + (1.0 - t.air) / p_[beta]) / (volume + 1.0 - t.air);
}

double Actuator::orifice(int side, double drop, double chamber, double other, const Terms& t) const {
  const double forward = 0.5 * (1.0 + std::tanh(p_[k_V] * (drop - p_[p_crack] + t.crack[side])));
  const double pilot = 0.5 * (1.0 + std::tanh(p_[g_V] * (p_[r_pilot] * (other - p_[p_0]) - (chamber - p_[p_0]))));
  const double flow =
      p_[c_D] * p_[a_V] * std::max(forward, pilot) * std::sqrt(2.0 / p_[rho]) * drop / std::sqrt(std::abs(drop) + 1e3);
  if (t.orifice_loss[side] == 0.0) return flow;
  return flow * (1.0 - t.orifice_loss[side] * std::exp(-std::abs(flow) / t.orifice_flow[side]));
}

// Flow through valve and line in series: what the line takes, the valve lacks. The flow grows with the drop, so the
// root is bracketed; found by the Illinois rule.
double Actuator::valve_flow(int side, double port, double chamber, double other, const Terms& t) const {
  const double drop = port - chamber, free_flow = orifice(side, drop, chamber, other, t);
  if (t.line[side] == 0.0 && t.line_square[side] == 0.0) return free_flow;
  const auto excess = [&](double q) {
    const double lost = t.line[side] * q + t.line_square[side] * q * std::abs(q);
    return q - orifice(side, drop - lost, chamber, other, t);
  };
  double low = 0.0, high = free_flow, at_low = excess(low), at_high = excess(high), q = free_flow;
  for (int k = 0; k < 80 && std::abs(high - low) > 1e-16; ++k) {
    if (at_high == at_low) break;
    q = high - at_high * (high - low) / (at_high - at_low);
    const double at_q = excess(q);
    if (std::abs(at_q) < 1e-17) break;
    if ((at_q > 0.0) != (at_high > 0.0)) {
      low = high;
      at_low = at_high;
    } else {
      at_low *= 0.5;
    }
    high = q;
    at_high = at_q;
  }
  return q;
}

void Actuator::add(const Effect& e, const Vector& y, Terms& t, Vector& dy) const {
  if (e.kind.form <= Form::trapezoidal_backlash ||
      (e.kind.form >= Form::karnopp && e.kind.form <= Form::triangular_bump))
    return add_force(e, y, t, dy);
  if (e.kind.form >= Form::rounded_shaft_friction && e.kind.form <= Form::self_heating)
    return add_electric(e, y, t, dy);
  add_flow(e, y, t, dy);
}

void Actuator::add_force(const Effect& e, const Vector& y, Terms& t, Vector& dy) const {
  const double s = e.strength, v = y[kV], x = y[kX], hidden = e.state < 0 ? 0.0 : y[e.state];
  switch (e.kind.form) {
    case Form::arctangent_friction:
      t.force += s * std::atan(v / e.a) * 2.0 / std::numbers::pi;
      return;
    case Form::exponential_stribeck:
      t.force += s * (1.0 + e.b * std::exp(-std::abs(v) / 3e-4)) * rounded_sign(v, e.a);
      return;
    case Form::friction_by_difference:
      t.force += s * std::abs(y[kPa] - y[kPb]) * rounded_sign(v, e.a);
      return;
    case Form::friction_by_sum:
      t.force += s * (y[kPa] + y[kPb]) * rounded_sign(v, e.a);
      return;
    case Form::lugre:
      t.force += s * hidden / e.a;
      dy[e.state] = v - std::abs(v) * hidden / (e.a * (1.0 + 0.2 * std::exp(-v * v / 4e-8)));
      return;
    case Form::rounded_quadratic_drag:
      t.force += s * v * std::sqrt(v * v + e.a * e.a);
      return;
    case Form::softening_spring:
      t.force += s * x * (1.0 - e.a * x / p_[x_C]);
      return;
    case Form::cosine_bump:
      if (std::abs(x - e.a) < 2.0 * e.b)
        t.force += s * std::pow(std::cos(std::numbers::pi * (x - e.a) / (4.0 * e.b)), 2);
      return;
    case Form::polynomial_step: {
      const double part = std::clamp((x - e.a) / (2.0 * e.b) + 0.5, 0.0, 1.0);
      t.force += s * part * part * (3.0 - 2.0 * part);
      return;
    }
    case Form::bouc_wen:
      t.force += s * hidden;
      dy[e.state] = v * (1.0 - hidden * hidden * 0.5 * (1.0 + sign_of(v * hidden))) / e.a;
      return;
    case Form::trapezoidal_backlash: {
      const double inside = std::min(hidden, e.a - hidden) / e.a;
      t.force -= s * std::clamp(inside / 0.08, 0.0, 1.0);
      dy[e.state] = -v;
      if (hidden >= e.a && v < 0.0) dy[e.state] = -200.0 * (hidden - e.a);
      if (hidden <= 0.0 && v > 0.0) dy[e.state] = -200.0 * hidden;
      return;
    }
    case Form::karnopp:
      t.slide += s;
      t.stick += s * e.b;
      return;
    case Form::direction_friction:
      t.force += s * std::clamp(v / 2e-5, -e.a, 1.0);
      return;
    case Form::root_drag:
      t.force += s * sign_of(v) * std::sqrt(std::abs(v));
      return;
    case Form::cubic_spring:
      t.force += s * std::pow(x - e.a, 3);
      return;
    case Form::triangular_bump:
      t.force += s * std::max(0.0, 1.0 - std::abs(x - e.a) / e.b);
      return;
    default:
      return;
  }
}

void Actuator::add_flow(const Effect& e, const Vector& y, Terms& t, Vector& dy) const {
  const std::string_view element = e.kind.element;
  const int side = element == "valve_2" || element == "chamber_b" ? 1 : 0;
  const double s = e.strength, omega = y[kOmega], slip_drop = y[kP1] - y[kP2], seal_drop = y[kPa] - y[kPb];
  const double pressure = y[kPa + side], over = pressure - p_[p_0];
  switch (e.kind.form) {
    case Form::blended_seal_leakage:
      t.seal += s * blended_root(seal_drop, e.a);
      return;
    case Form::blended_pump_slip:
      t.slip += s * blended_root(slip_drop, e.a);
      return;
    case Form::drag_slip:
      t.slip += s * omega;
      return;
    case Form::rounded_filling_slip:
      t.slip += s * omega * std::hypot(omega, e.a);
      return;
    case Form::rounded_rising_slip:
      t.slip += s * std::hypot(omega, e.a) * slip_drop;
      return;
    case Form::tooth_ripple:
      t.slip += s * omega * std::cos(e.a * y[e.state]);
      dy[e.state] = omega;
      return;
    case Form::speed_limited_delivery:
      t.slip += s * std::max(0.0, std::abs(omega) - e.a) * sign_of(omega);
      return;
    case Form::laminar_line:
      t.line[side] += s;
      return;
    case Form::turbulent_line:
      t.line_square[side] += s;
      return;
    case Form::flow_held_poppet:
      t.crack[side] += s * y[e.state];  // its rate needs the flow
      return;
    case Form::reynolds_orifice:
      t.orifice_loss[side] = s;
      t.orifice_flow[side] = e.a;
      return;
    case Form::thinning_leak:
      t.leak[side] += s * over * (1.0 + over / e.a);
      return;
    case Form::blended_leak:
      t.leak[side] += s * blended_root(over, e.a);
      return;
    case Form::relief_leak:
      t.leak[side] += s * std::max(0.0, pressure - e.a);
      return;
    case Form::exponential_hose:
      t.compliance[side] += s * std::exp(-pressure / e.a);
      return;
    case Form::mixture_air:
      t.air = s;
      t.air_exponent = e.a;
      return;
    case Form::exponential_warm_up:
      t.viscosity *= std::exp(-s * y[e.state]);
      dy[e.state] = (1.0 - y[e.state]) / e.a;
      return;
    case Form::scratched_bore: {
      const double edge = std::clamp((e.b - std::abs(y[kX] - e.a)) / 2e-4 + 0.5, 0.0, 1.0);
      t.seal += s * edge * seal_drop;
      return;
    }
    case Form::lag:
      dy[e.state] = (y[kChannels[e.channel].state] - y[e.state]) / e.strength;
      return;
    default:
      return;
  }
}

void Actuator::add_electric(const Effect& e, const Vector& y, Terms& t, Vector& dy) const {
  const double s = e.strength, omega = y[kOmega], current = y[kI];
  switch (e.kind.form) {
    case Form::rounded_shaft_friction:
      t.torque += s * rounded_sign(omega, e.a);
      return;
    case Form::shaft_friction_by_load:
      t.torque += s * std::abs(y[kP1] - y[kP2]) * rounded_sign(omega, e.a);
      return;
    case Form::cogging_with_harmonic:
      t.torque += s * (std::sin(e.a * y[e.state]) + 0.15 * std::sin(2.0 * e.a * y[e.state] + 1.0));
      dy[e.state] = omega;
      return;
    case Form::tanh_saturation: {
      const double knee = std::sqrt(p_[T_M] / (3.0 * s));
      t.torque += p_[T_M] * (current - knee * std::tanh(current / knee));
      return;
    }
    case Form::rounded_voltage_loss:
      t.command += s * rounded_sign(current, e.a);
      return;
    case Form::rounded_dead_zone:
      t.command += s * rounded_sign(t.voltage, e.a);
      return;
    case Form::self_heating:
      t.winding += s * y[e.state] * current;
      dy[e.state] = (current * current * (1.0 + s * y[e.state] / p_[R_M]) - y[e.state]) / e.a;
      return;
    default:
      return;
  }
}

void Actuator::rates(double voltage, const Vector& y, Vector& dy) const {
  Terms t;
  t.voltage = voltage;
  for (const auto& e : effects_) {
    add(e, y, t, dy);
    if (e.kind.form == Form::hard_dead_zone) t.command += std::clamp(voltage, -e.strength, e.strength);
    if (e.kind.form == Form::hard_knee) t.torque += e.strength * std::max(0.0, std::abs(y[kI]) - e.a) * sign_of(y[kI]);
  }
  const double v = y[kV], x = y[kX], area = p_[A_C];
  const double q1 = valve_flow(0, y[kP1], y[kPa], y[kP2], t), q2 = valve_flow(1, y[kP2], y[kPb], y[kP1], t);
  const auto make_up = [&](double p) {
    const double s = 2e4, w = (p_[p_0] - p) / s;
    return p_[K_MU] * s * (w > 30.0 ? w : std::log1p(std::exp(w)));
  };
  const double slip = (y[kP1] - y[kP2]) / (p_[R_PL] * t.viscosity) + t.slip;
  const double seal = (y[kPa] - y[kPb]) / (p_[R_CL] * t.viscosity) + t.seal;
  const auto rise = [&](double volume, double extra, double p, double inflow) {
    return inflow / (volume * inverse_modulus(p, t) + extra);
  };
  dy[kZ] = (voltage - t.command - y[kZ]) / (p_[R_M] * p_[C_M]);
  dy[kI] = (y[kZ] - p_[R_M] * y[kI] - t.winding - p_[Omega_M] * y[kOmega]) / p_[L_M];
  dy[kOmega] =
      (p_[T_M] * y[kI] - (p_[f_M] + p_[d_P]) * t.viscosity * y[kOmega] - p_[alpha_P] * (y[kP1] - y[kP2]) - t.torque) /
      p_[J_M];
  dy[kP1] = rise(p_[V_P], 0.0, y[kP1], p_[alpha_P] * y[kOmega] - slip - q1 + make_up(y[kP1]));
  dy[kP2] = rise(p_[V_P], 0.0, y[kP2], -p_[alpha_P] * y[kOmega] + slip - q2 + make_up(y[kP2]));
  dy[kPa] = rise(p_[V_0] + area * x, t.compliance[0], y[kPa], q1 - area * v - seal - t.leak[0]);
  dy[kPb] = rise(p_[V_0] + area * (p_[x_C] - x), t.compliance[1], y[kPb], q2 + area * v + seal - t.leak[1]);
  double driving = area * (y[kPa] - y[kPb]) - p_[phi] - t.force;
  if (t.slide > 0.0) driving -= std::abs(v) < 1e-6 ? std::clamp(driving, -t.stick, t.stick) : std::copysign(t.slide, v);
  dy[kV] = (driving - p_[f_C] * t.viscosity * v) / p_[m_C];
  dy[kX] = v;
  dy[kFlowSeen] = (q1 - y[kFlowSeen]) / 0.05;
  dy[kPaSeen] = (y[kPa] - y[kPaSeen]) / 0.005;
  dy[kPbSeen] = (y[kPb] - y[kPbSeen]) / 0.005;
  dy[kXSeen] = (x - y[kXSeen]) / 0.002;
  dy[kVSeen] = (v - y[kVSeen]) / 0.005;
  for (const auto& e : effects_) {
    if (e.kind.form != Form::flow_held_poppet) continue;
    const double q = std::string_view(e.kind.element) == "valve_2" ? q2 : q1;
    dy[e.state] = (0.5 * (1.0 + std::tanh(2.0 * q / e.a - 2.0)) - y[e.state]) / 0.02;
  }
}

}  // namespace second_generator

#include "services/verification/truth/plant.hpp"

#include <algorithm>
#include <cmath>

namespace sealwatch::bench {
namespace {

using namespace truth_index;

double sigmoid(double a) { return 0.5 * (1.0 + std::tanh(a)); }

double make_up(double pressure, const TruthParameters& p) {
  const double a = (p.reservoir_pressure - pressure) / p.make_up_rounding;
  const double softplus = a > 30.0 ? a : std::log1p(std::exp(a));
  return p.make_up_conductance * p.make_up_rounding * softplus;
}

/// q with q = flow(drop - loss(q)), between 0 and the flow without the line: bisection and regula falsi by Illinois.
template <class F>
double solve_line(const F& flow, double drop, const LineLoss& line) {
  const double free = flow(drop);
  if (!line.any() || free == 0.0) return free;
  const auto loss = [&](double q) {
    return line.laminar * q + std::copysign(line.power * std::pow(std::abs(q), line.exponent), q);
  };
  const auto miss = [&](double q) { return q - flow(drop - loss(q)); };
  double a = 0.0, b = free, at_a = miss(a), at_b = miss(b);
  if (at_a * at_b >= 0.0) return free;
  for (int k = 0; k < 200 && std::abs(b - a) > 1e-13 * std::abs(free); ++k) {
    double c = (at_b * a - at_a * b) / (at_b - at_a);
    if (k % 4 == 3) c = 0.5 * (a + b);
    const double at_c = miss(c);
    if (at_c == 0.0) return c;
    if (at_c * at_b < 0.0) {
      a = b;
      at_a = at_b;
    } else {
      at_a *= 0.5;
    }
    b = c;
    at_b = at_c;
  }
  return b;
}

}  // namespace

double truth_valve_flow(double port, double chamber, double other_port, const TruthParameters& p, const LineLoss& line,
                        double cracking_relief) {
  const double pilot = sigmoid(
      p.pilot_steepness * (p.pilot_ratio * (other_port - p.reservoir_pressure) - (chamber - p.reservoir_pressure)));
  const double full = p.valve_discharge * p.valve_area * std::sqrt(2.0 / p.oil_density);
  const auto flow = [&](double drop) {
    const double forward = sigmoid(p.forward_steepness * (drop - p.cracking_pressure + cracking_relief));
    return full * std::max(forward, pilot) * drop / std::sqrt(std::abs(drop) + p.orifice_rounding);
  };
  return solve_line(flow, port - chamber, line);
}

namespace {

/// The ends are cushioned over 2 mm; trials stay away from them, so that their rounding does not matter.
double cushion_N(double x, double v, double stroke) {
  constexpr double kLength_m = 2e-3, kStiffness = 4e8, kDamping = 1e6;
  if (const double in = kLength_m - x; in > 0.0) return -(kStiffness * in + kDamping * std::max(-v, 0.0));
  if (const double in = x - (stroke - kLength_m); in > 0.0) return kStiffness * in + kDamping * std::max(v, 0.0);
  return 0.0;
}

}  // namespace

double truth_inlet_flow(const TruthState& y, const TruthParameters& p, const TruthAdditions& more) {
  return truth_valve_flow(y[kPort1], y[kChamberA], y[kPort2], p, more.line[0], more.cracking_relief_Pa[0]);
}

TruthState truth_rates(const TruthState& y, double command_V, const TruthParameters& p, const TruthAdditions& more) {
  const double viscosity = more.viscosity;
  const double lift = y[kPort1] - y[kPort2];
  const double across = y[kChamberA] - y[kChamberB];
  const double slip = lift / (p.pump_resistance * viscosity) + more.pump_slip_m3_s;
  const double leak = across / (p.seal_resistance * viscosity) + more.seal_leakage_m3_s;
  const double delivered = p.displacement * y[kShaft] - slip;
  const double into_a = truth_inlet_flow(y, p, more);
  const double into_b =
      truth_valve_flow(y[kPort2], y[kChamberB], y[kPort1], p, more.line[1], more.cracking_relief_Pa[1]);
  const double swept = p.piston_area * y[kSpeed];
  const double volume_a = p.dead_volume + p.piston_area * y[kPosition];
  const double volume_b = p.dead_volume + p.piston_area * (p.stroke - y[kPosition]);
  const auto capacity = [&](double volume, std::size_t which) {
    return volume * (1.0 / p.oil_modulus + more.softness_1_Pa[which]);
  };
  const double drag = p.piston_viscosity * viscosity * y[kSpeed];
  const double torque_lost = (p.motor_viscosity + p.pump_viscosity * viscosity) * y[kShaft] + more.shaft_torque_Nm;

  TruthState dy{};
  dy[kVoltage] = (command_V - more.driver_loss_V - y[kVoltage]) / (p.winding_resistance * p.driver_capacitance);
  dy[kCurrent] = (y[kVoltage] - p.winding_resistance * y[kCurrent] - p.back_emf * y[kShaft] - more.winding_loss_V) /
                 p.winding_inductance;
  dy[kShaft] = (p.torque_constant * y[kCurrent] - p.displacement * lift - torque_lost) / p.shaft_inertia;
  dy[kPort1] = (delivered - into_a + make_up(y[kPort1], p)) / capacity(p.port_volume, 0);
  dy[kPort2] = (-delivered - into_b + make_up(y[kPort2], p)) / capacity(p.port_volume, 1);
  dy[kChamberA] = (into_a - swept - leak - more.outflow_m3_s[0]) / (capacity(volume_a, 2) + more.compliance_m3_Pa[0]);
  dy[kChamberB] = (into_b + swept + leak - more.outflow_m3_s[1]) / (capacity(volume_b, 3) + more.compliance_m3_Pa[1]);
  dy[kSpeed] =
      (p.piston_area * across - drag - p.load - cushion_N(y[kPosition], y[kSpeed], p.stroke) - more.piston_force_N) /
      p.moving_mass;
  dy[kPosition] = y[kSpeed];
  return dy;
}

}  // namespace sealwatch::bench

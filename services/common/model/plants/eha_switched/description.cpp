// The table of plant `eha_switched`: a bench with DC motor, one-way gear pump, directional valves, single-rod cylinder
// and accumulator. The defaults are the values of the bench's author; he has no seal leakage, so R_CL starts
// practically infinite.
#include "sealwatch/model/eha_switched.hpp"
#include "services/common/model/plant_tables.hpp"

namespace sealwatch {
namespace {

std::vector<ChannelDescription> channels() {
  return {
      {.name = "position_reference",
       .unit = "m",
       .meaning = "set-point of the position (not simulated)",
       .input = true,
       .role = ChannelRole::reference},
      {.name = "position",
       .unit = "m",
       .meaning = "piston position x, 0 = retracted",
       .noise_std = 1.0e-5,
       .range_min = -0.005,
       .range_max = 0.080,
       .role = ChannelRole::stroke},
      {.name = "pressure_a",
       .unit = "Pa",
       .meaning = "chamber A (piston side) pressure above ambient",
       .noise_std = 1.2e4,
       .range_min = -2.0e5,
       .range_max = 2.5e7,
       .role = ChannelRole::pressure_up},
      {.name = "pressure_b",
       .unit = "Pa",
       .meaning = "chamber B (rod side) pressure above ambient",
       .noise_std = 6.0e4,
       .range_min = -2.0e5,
       .range_max = 2.5e7,
       .role = ChannelRole::pressure_down},
      {.name = "shaft_speed",
       .unit = "rad/s",
       .meaning = "shaft speed with the sign of the valves' direction",
       .noise_std = 2.0,
       .range_min = -500.0,
       .range_max = 500.0,
       .role = ChannelRole::shaft_speed},
      {.name = "pump_angle",
       .unit = "rad",
       .meaning = "pump shaft angle, unwrapped",
       .noise_std = 1.0e-2,
       .range_min = 0.0,
       .range_max = 0.0,
       .role = ChannelRole::shaft_angle},
      {.name = "motor_duty",
       .unit = "1",
       .meaning = "share of the supply voltage with the sign of the valves' direction",
       .input = true,
       .range_min = -1.05,
       .range_max = 1.05,
       .role = ChannelRole::drive},
      {.name = "motor_current_raw",
       .unit = "1",
       .meaning = "uncalibrated motor current (not simulated)",
       .noise_std = 2.0,
       .range_min = 0.0,
       .range_max = 4096.0},
      {.name = "valve_state",
       .unit = "1",
       .meaning = "directional valves: +1 extends, -1 retracts, 0 blocks",
       .input = true,
       .range_min = -1.0,
       .range_max = 1.0,
       .hold = true},
  };
}

std::vector<ParameterDescription> parameters() {
  return {
      scale_parameter("U_supply", "V", 24.0, "supply voltage at duty 1"),
      scale_parameter("R_M", "ohm", 0.32, "winding resistance", true),
      scale_parameter("L_M", "H", 2e-3, "winding inductance"),
      scale_parameter("Omega_M", "V s/rad", 0.0859437, "back-EMF and torque constant (0.009 V/rpm)"),
      scale_parameter("J_M", "kg m2", 1e-9, "inertia of motor and pump shaft"),
      scale_parameter("f_M", "N m s/rad", 1e-3, "viscous friction of the motor"),
      scale_parameter("T_0", "N m", 0.05, "no-load torque of the pump", true),
      scale_parameter("k_T", "N m/Pa", 6e-7, "friction torque of the pump per pressure difference"),
      scale_parameter("alpha_P", "m3/rad", 2.54648e-7, "pump displacement (1.6 cm3/rev)"),
      bounded_parameter("R_PL", "Pa s/m3", 7.8125e12, 7.8125e10, 7.8125e14,
                        "leakage resistance of the pump (volumetric efficiency 0.92 at 1500 rpm, 250 bar)", true),
      scale_parameter("c_D", "1", 0.7, "discharge coefficient of the directional valves"),
      scale_parameter("a_V", "m2", 1.3e-5, "opening area of the directional valves"),
      scale_parameter("rho", "kg/m3", 900.0, "oil density"),
      scale_parameter("nu", "m2/s", 18e-6, "kinematic viscosity"),
      scale_parameter("beta", "Pa", 1.6e9, "bulk modulus of the oil without air"),
      bounded_parameter("air_fraction", "1", 1e-3, 0.0, 0.2, "share of undissolved air in the oil at ambient pressure"),
      scale_parameter("p_ambient", "Pa", 1.01325e5, "ambient pressure"),
      scale_parameter("d_pipe", "m", 5e-3, "bore of the pipes"),
      scale_parameter("l_supply", "m", 1.0, "pipe from pump to valves, and from valves to accumulator"),
      scale_parameter("l_chamber", "m", 2.0, "pipe from the valves to each chamber"),
      scale_parameter("V_accumulator", "m3", 3.5e-4, "volume of the accumulator"),
      scale_parameter("p_preload", "Pa", 2e5, "preload of the accumulator's gas above ambient"),
      scale_parameter("A_A", "m2", 1.963495e-3, "piston area on chamber A"),
      scale_parameter("A_B", "m2", 1.649336e-3, "piston area on chamber B"),
      scale_parameter("V_0", "m3", 1e-6, "dead volume of one chamber"),
      bounded_parameter("R_CL", "Pa s/m3", 1e16, 1e10, 1e17,
                        "leakage resistance of the piston seal (the author has none)", true),
      scale_parameter("m_C", "kg", 1.0, "moving mass"),
      bounded_parameter("f_C", "N s/m", 10.0, 0.1, 1e6,
                        "viscous friction of piston and rod (the author has none; 10 N s/m is nothing here)", true),
      scale_parameter("phi", "N", 2000.0,
                      "load on the rod while it extends or stands; each recording has its own factor"),
      scale_parameter("x_C", "m", 0.075, "stroke"),
      scale_parameter("k_cushion", "N/m", 1e8, "stiffness of the end stops"),
      scale_parameter("d_cushion", "N s/m", 1e5, "damping of the end stops against motion into the end"),
  };
}

std::vector<StateDescription> states() {
  return {
      {"i", "A", "motor current"},  {"omega", "rad/s", "shaft speed"}, {"theta", "rad", "shaft angle"},
      {"p_P", "Pa", "supply line"}, {"p_A", "Pa", "chamber A"},        {"p_B", "Pa", "chamber B"},
      {"p_T", "Pa", "accumulator"}, {"v", "m/s", "piston velocity"},   {"x", "m", "piston position"},
  };
}

std::vector<ElementDescription> elements() {
  return {
      {"driver", "voltage from duty to winding"},
      {"winding", "winding voltage balance"},
      {"shaft", "torque on motor and pump shaft"},
      {"pump", "flow from the accumulator to the supply line"},
      {"valve_1", "directional valve and line to chamber A"},
      {"valve_2", "directional valve and line to chamber B"},
      {"chamber_a", "volume balance of chamber A"},
      {"chamber_b", "volume balance of chamber B"},
      {"accumulator", "volume balance of the accumulator"},
      {"piston_seal", "flow from chamber A to B"},
      {"piston", "force on piston and rod, load included"},
      {"fluid", "properties of the oil in all volumes"},
  };
}

}  // namespace

PlantDescription describe_eha_switched() {
  PlantDescription plant{
      .name = "eha_switched",
      .meaning = "bench with one-way pump, directional valves and single-rod cylinder",
      .channels = channels(),
      .parameters = parameters(),
      .states = states(),
      .elements = elements(),
      .sites = {EhaSwitched::kSites.begin(), EhaSwitched::kSites.end()},
      .law_sizes = reference_sizes(),
      .window_s = 2.0,
      .load_parameter = "phi",
      .wear_parameter = "R_CL",
      .condition = ConditionSetting{
          .parameter = "R_CL", .at_100 = 2.6e13, .at_60 = 4.64e12, .unit = "Pa s/m3", .part = "piston seal"}};
  set_role(plant, "x_C", ParameterRole::stroke);
  set_role(plant, "A_A", ParameterRole::area_up);
  set_role(plant, "A_B", ParameterRole::area_down);
  set_role(plant, "V_0", ParameterRole::dead_volume);
  set_role(plant, "beta", ParameterRole::bulk_modulus);
  set_role(plant, "alpha_P", ParameterRole::displacement);
  set_role(plant, "R_M", ParameterRole::motor_resistance);
  set_role(plant, "R_CL", ParameterRole::seal_leakage);
  set_role(plant, "R_PL", ParameterRole::pump_leakage);
  set_role(plant, "Omega_M", ParameterRole::back_emf);
  set_role(plant, "f_M", ParameterRole::motor_friction);
  add_sensor_elements(plant);
  return plant;
}

}  // namespace sealwatch

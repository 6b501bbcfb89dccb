// The table of plant `eha`: nominal asset of the reference model (a 300 W class actuator). Symbols as in
// include/sealwatch/model/eha.hpp, whose EhaParameters has the same names in the same order (a test compares them).
#include "sealwatch/model/eha.hpp"
#include "sealwatch/model/law_references.hpp"
#include "services/common/model/plant_tables.hpp"

namespace sealwatch {
namespace {

std::vector<ChannelDescription> channels() {
  return {
      {.name = "motor_voltage",
       .unit = "V",
       .meaning = "driver voltage command u",
       .input = true,
       .range_min = -66.0,
       .range_max = 66.0,
       .role = ChannelRole::drive},
      {.name = "motor_current",
       .unit = "A",
       .meaning = "winding current i",
       .noise_std = 0.02,
       .range_min = -100.0,
       .range_max = 100.0,
       .role = ChannelRole::current},
      {.name = "shaft_speed",
       .unit = "rad/s",
       .meaning = "motor and pump shaft speed",
       .noise_std = 0.5,
       .range_min = -500.0,
       .range_max = 500.0,
       .role = ChannelRole::shaft_speed},
      {.name = "pressure_a",
       .unit = "Pa",
       .meaning = "chamber A pressure",
       .noise_std = 1.0e4,
       .time_constant_s = 5e-3,
       .range_min = -1.0e6,
       .range_max = 6.0e7,
       .role = ChannelRole::pressure_up},
      {.name = "pressure_b",
       .unit = "Pa",
       .meaning = "chamber B pressure",
       .noise_std = 1.0e4,
       .time_constant_s = 5e-3,
       .range_min = -1.0e6,
       .range_max = 6.0e7,
       .role = ChannelRole::pressure_down},
      {.name = "pressure_differential",
       .unit = "Pa",
       .meaning = "p_A - p_B",
       .noise_std = 1.0e4,
       .time_constant_s = 5e-3,
       .range_min = -6.0e7,
       .range_max = 6.0e7,
       .role = ChannelRole::pressure_difference},
      {.name = "flow",
       .unit = "m3/s",
       .meaning = "flow into chamber A",
       .noise_std = 4.0e-8,
       .time_constant_s = 50e-3,
       .range_min = -1.0e-4,
       .range_max = 1.0e-4,
       .role = ChannelRole::flow},
      {.name = "position",
       .unit = "m",
       .meaning = "piston position x, 0 = valve closed",
       .noise_std = 5.0e-6,
       .time_constant_s = 2e-3,
       .range_min = -0.005,
       .range_max = 0.085,
       .role = ChannelRole::stroke},
      {.name = "velocity",
       .unit = "m/s",
       .meaning = "piston velocity v",
       .noise_std = 1.0e-5,
       .time_constant_s = 5e-3,
       .range_min = -0.1,
       .range_max = 0.1,
       .role = ChannelRole::speed},
      {.name = "rod_force",
       .unit = "N",
       .meaning = "load on the rod, positive against +x",
       .noise_std = 100.0,
       .range_min = -5.0e5,
       .range_max = 5.0e5,
       .role = ChannelRole::force},
      {.name = "fluid_temperature",
       .unit = "K",
       .meaning = "oil temperature (recorded, not simulated)",
       .noise_std = 0.1,
       .range_min = 253.15,
       .range_max = 393.15,
       .role = ChannelRole::temperature},
  };
}

std::vector<ParameterDescription> parameters() {
  return {
      scale_parameter("R_M", "ohm", 0.5, "winding and driver resistance", true),
      scale_parameter("C_M", "F", 4e-3, "driver filter capacitance; R_M C_M is the driver's time constant"),
      scale_parameter("L_M", "H", 1.5e-3, "winding inductance"),
      scale_parameter("Omega_M", "V s/rad", 0.20, "back-EMF constant"),
      scale_parameter("T_M", "N m/A", 0.20, "torque constant"),
      scale_parameter("J_M", "kg m2", 4e-4, "inertia of motor and pump shaft"),
      scale_parameter("f_M", "N m s/rad", 8e-4, "viscous friction of the motor; only f_M + d_P is identifiable", true),
      scale_parameter("d_P", "N m s/rad", 2e-4, "viscous friction of the pump"),
      scale_parameter("alpha_P", "m3/rad", 3.98e-8, "pump displacement (0.25 cm3/rev)"),
      scale_parameter("R_PL", "Pa s/m3", 5e13, "leakage resistance of the pump", true),
      scale_parameter("V_P", "m3", 2e-5, "volume of one pump port"),
      scale_parameter("c_D", "1", 0.6, "discharge coefficient of the check valves; only c_D a_V is identifiable"),
      scale_parameter("a_V", "m2", 5e-6, "opening area of the check valves"),
      scale_parameter("k_V", "1/Pa", 2e-5, "steepness of the forward opening"),
      scale_parameter("g_V", "1/Pa", 5e-7, "steepness of the pilot opening"),
      scale_parameter("p_crack", "Pa", 5e4, "cracking pressure of the check valves"),
      scale_parameter("r_pilot", "1", 3.0, "pilot area ratio"),
      scale_parameter("eps_V", "Pa", 1e3, "pressure drop below which the orifice law is linear"),
      scale_parameter("rho", "kg/m3", 870.0, "oil density"),
      scale_parameter("beta", "Pa", 1.2e9, "bulk modulus of the oil", true),
      scale_parameter("p_0", "Pa", 1.0e6, "pressure of the compensated reservoir"),
      scale_parameter("K_MU", "m3/(s Pa)", 1e-11, "conductance of the make-up flow"),
      scale_parameter("s_MU", "Pa", 2e4, "smoothness of the make-up flow"),
      bounded_parameter("p_ambient", "Pa", 0.0, 0.0, 1.2e8,
                        "ambient pressure, added where a fluid property asks for absolute pressure"),
      scale_parameter("A_C", "m2", 5.89e-3, "piston area on chamber A"),
      bounded_parameter("area_ratio", "1", 1.0, 0.1, 10.0, "piston area on chamber B over that on chamber A"),
      scale_parameter("V_0", "m3", 5e-5, "dead volume of one chamber"),
      scale_parameter("R_CL", "Pa s/m3", 2.6e13, "leakage resistance of the piston seal: what the prognosis tracks",
                      true),
      scale_parameter("m_C", "kg", 50.0, "moving mass"),
      scale_parameter("f_C", "N s/m", 2.0e6, "viscous friction of piston and rod", true),
      bounded_parameter("phi", "N", 6.0e4, 6.0e3, 6.0e5,
                        "mean load on the rod, positive against +x; each recording has its own factor"),
      scale_parameter("x_C", "m", 0.080, "stroke"),
      scale_parameter("x_cushion", "m", 2e-3, "length of the end cushion"),
      scale_parameter("k_cushion", "N/m", 4e8, "stiffness of the end cushion"),
      scale_parameter("d_cushion", "N s/m", 1e6, "damping of the end cushion against motion into the end"),
  };
}

std::vector<StateDescription> states() {
  return {
      {"z", "V", "voltage behind the driver filter"},
      {"i", "A", "winding current"},
      {"omega", "rad/s", "shaft speed"},
      {"p_1", "Pa", "pump port 1"},
      {"p_2", "Pa", "pump port 2"},
      {"p_A", "Pa", "chamber A"},
      {"p_B", "Pa", "chamber B"},
      {"v", "m/s", "piston velocity"},
      {"x", "m", "piston position"},
  };
}

std::vector<ElementDescription> elements() {
  return {
      {"driver", "voltage from command to winding"},
      {"winding", "winding voltage balance"},
      {"shaft", "torque on motor and pump shaft"},
      {"pump", "flow between the pump ports"},
      {"valve_1", "between pump port 1 and chamber A: check valve, line"},
      {"valve_2", "between pump port 2 and chamber B: check valve, line"},
      {"chamber_a", "volume balance of chamber A"},
      {"chamber_b", "volume balance of chamber B"},
      {"piston_seal", "flow from chamber A to B"},
      {"piston", "force on piston and rod, load included"},
      {"fluid", "properties of the oil in all volumes"},
  };
}

}  // namespace

PlantDescription describe_eha() {
  PlantDescription plant{
      .name = "eha",
      .meaning = "closed-circuit electro-hydrostatic actuator with pilot-operated check valves",
      .channels = channels(),
      .parameters = parameters(),
      .states = states(),
      .elements = elements(),
      .sites = {Eha::kSites.begin(), Eha::kSites.end()},
      .law_sizes = reference_sizes(),
      .load_parameter = "phi",
      .wear_parameter = "R_CL",
      .condition =
          ConditionSetting{
              .parameter = "R_CL", .at_100 = 2.6e13, .at_60 = 4.64e12, .unit = "Pa s/m3", .part = "piston seal"},
      .judged = true};
  set_role(plant, "x_C", ParameterRole::stroke);
  set_role(plant, "A_C", ParameterRole::area_up);
  set_role(plant, "area_ratio", ParameterRole::area_ratio);
  set_role(plant, "V_0", ParameterRole::dead_volume);
  set_role(plant, "beta", ParameterRole::bulk_modulus);
  set_role(plant, "alpha_P", ParameterRole::displacement);
  set_role(plant, "R_M", ParameterRole::motor_resistance);
  set_role(plant, "T_M", ParameterRole::torque_constant);
  set_role(plant, "R_CL", ParameterRole::seal_leakage);
  set_role(plant, "R_PL", ParameterRole::pump_leakage);
  set_role(plant, "d_P", ParameterRole::pump_friction);
  set_role(plant, "Omega_M", ParameterRole::back_emf);
  set_role(plant, "f_M", ParameterRole::motor_friction);
  add_sensor_elements(plant);
  return plant;
}

std::vector<LawReference> law_references() {
  constexpr double kPressure_Pa = 1e7;  // under which the pump's torque is meant
  const PlantDescription eha = describe_eha();
  const auto value = [&](std::string_view parameter) { return eha.find_parameter(parameter)->value; };
  return {
      {"N", value("phi"), "load on its rod"},
      {"m", value("x_C"), "its stroke"},
      {"m2", value("A_C"), "area of its piston"},
      {"N s/m", value("f_C"), "viscous friction of its piston"},
      {"N m", value("alpha_P") * kPressure_Pa, "torque on its shaft"},
      {"N m s/rad", value("f_M") + value("d_P"), "viscous friction of its shaft"},
      {"m3/rad", value("alpha_P"), "displacement of its pump"},
      {"N m/A", value("T_M"), "torque constant of its motor"},
      {"ohm", value("R_M"), "resistance of its winding"},
      {"m3/Pa", value("V_0") / value("beta"), "compliance of the oil in a chamber"},
      {"s", eha.find_channel(ChannelRole::pressure_up)->time_constant_s, "time constant of its sensors"},
  };
}

}  // namespace sealwatch

// The table of plant `emps`. The defaults are the reference model's published values (model/emps.hpp).
#include "sealwatch/model/emps.hpp"
#include "services/common/model/plant_tables.hpp"

namespace sealwatch {
namespace {

std::vector<ChannelDescription> channels() {
  return {
      {.name = "motor_voltage",
       .unit = "V",
       .meaning = "voltage command u of the motor's driver",
       .input = true,
       .range_min = -10.0,
       .range_max = 10.0,
       .hold = true,
       .role = ChannelRole::drive},
      {.name = "position_reference",
       .unit = "m",
       .meaning = "set-point of the position (not simulated)",
       .input = true,
       .hold = true,
       .role = ChannelRole::reference},
      {.name = "position",
       .unit = "m",
       .meaning = "carriage position x",
       .noise_std = 2.0e-8,  // third differences of the published recording, whose grid is 5e-8 m
       .range_min = -0.01,
       .range_max = 0.30,
       .role = ChannelRole::stroke},
  };
}

std::vector<ParameterDescription> parameters() {
  return {
      scale_parameter("M", "kg", 95.11, "mass of the carriage with the motor's reduced inertia", true),
      scale_parameter("F_v", "N s/m", 203.5, "viscous friction of carriage, screw and motor", true),
      scale_parameter("k_F", "N/V", 35.15, "force per voltage; only M / k_F and F_v / k_F are identifiable"),
  };
}

// The motor moves the carriage with 150 N, where 60 kN move the stem of `eha`; it travels 0.25 m where that one is
// tested around 0.05 to 0.1 m, and turns at 0.13 m/s. Speeds at which friction changes do not grow with the speed of
// travel: a tenth of it.
std::vector<LawSize> law_sizes() {
  constexpr double kForce = 150.0 / 60e3, kWay = 2.5, kSpeed = 100.0;
  return {{"N", kForce},
          {"m", kWay},
          {"m/s", 0.1 * kSpeed},
          {"N/m", kForce / kWay},
          {"N/m2", kForce / (kWay * kWay)},
          {"N s/m", kForce / kSpeed},
          {"N s2/m2", kForce / (kSpeed * kSpeed)},
          {"V", 1.0},
          {"A", 1.0},
          {"s", 1.0},
          {"m2", kForce}};
}

}  // namespace

PlantDescription describe_emps() {
  PlantDescription plant{
      .name = "emps",
      .meaning = "electro-mechanical positioning drive with ball screw and carriage",
      .channels = channels(),
      .parameters = parameters(),
      .states = {{"x", "m", "carriage position"}, {"v", "m/s", "carriage velocity"}},
      .elements = {{"driver", "force of the motor from its voltage command"}, {"piston", "force on the carriage"}},
      .sites = {Emps::kSites.begin(), Emps::kSites.end()},
      .law_sizes = law_sizes(),
      .window_s = 2.0};
  add_sensor_elements(plant);
  return plant;
}

}  // namespace sealwatch

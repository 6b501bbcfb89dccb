#include "services/common/mismatch/site_words.hpp"

#include <algorithm>

namespace sealwatch::mismatch {
namespace {

constexpr SignalWords kCurrent{"motor current", "A", "i"};
constexpr SignalWords kShaftSpeed{"shaft speed", "rad/s", "omega"};
constexpr SignalWords kPumpPressure{"pump pressure difference", "Pa", "p_1 - p_2"};
constexpr SignalWords kValveFlow{"flow into the chamber", "m3/s", "q"};
constexpr SignalWords kValveDrop{"pressure drop over the valve", "Pa", "D"};
constexpr SignalWords kVelocity{"velocity", "m/s", "v"};
constexpr SignalWords kPosition{"position", "m", "x"};
constexpr SignalWords kNone{"", "", ""};

constexpr SiteWords kDriver{
    "voltage lost in the driver",
    "V",
    {kCurrent, {"commanded voltage", "V", "u"}, {"rate of the commanded voltage", "V/s", "du/dt"}, kNone}};
constexpr SiteWords kWinding{"voltage lost in the winding", "V", {kCurrent, kShaftSpeed, kNone, kNone}};
constexpr SiteWords kShaft{"torque against the rotation", "N m", {kShaftSpeed, kPumpPressure, kCurrent, kNone}};
constexpr SiteWords kPump{"flow from port 1 to port 2", "m3/s", {kPumpPressure, kShaftSpeed, kNone, kNone}};
constexpr SiteWords kLine{"pressure drop on the way to the chamber", "Pa", {kValveFlow, kValveDrop, kNone, kNone}};
constexpr SiteWords kCrack{"lowering of the cracking pressure", "Pa", {kValveDrop, kValveFlow, kNone, kNone}};
constexpr SiteWords kOutflow{"flow out of the chamber",
                             "m3/s",
                             {SignalWords{"pressure above the reservoir", "Pa", "p - p_0"}, kNone, kNone, kNone}};
constexpr SiteWords kCompliance{
    "compliance of the chamber", "m3/Pa", {SignalWords{"chamber pressure", "Pa", "p"}, kNone, kNone, kNone}};
constexpr SiteWords kSeal{
    "flow from chamber A to B",
    "m3/s",
    {SignalWords{"pressure difference across the piston", "Pa", "p_A - p_B"}, kVelocity, kPosition, kNone}};
constexpr SiteWords kPiston{
    "force against +x",
    "N",
    {kVelocity, kPosition, {"pressure in chamber A", "Pa", "p_A"}, {"pressure in chamber B", "Pa", "p_B"}}};
constexpr SiteWords kModulus{
    "softness of the oil, 1/beta", "1/Pa", {SignalWords{"pressure", "Pa", "p"}, kNone, kNone, kNone}};
constexpr SiteWords kViscosity{
    "relative change of viscosity", "1", {SignalWords{"dissipated power", "W", "P"}, kNone, kNone, kNone}};
constexpr SiteWords kTank{"flow out of the tank", "V/s", {SignalWords{"level", "V", "level"}, kNone, kNone, kNone}};
constexpr SiteWords kOwn{"what is lost", "", {SignalWords{"first signal", "", ""}, kNone, kNone, kNone}};
constexpr SiteWords kRecording{"error of the recording", "", {kNone, kNone, kNone, kNone}};
constexpr SiteWords kSensor{"shift of the reading", "", {kNone, kNone, kNone, kNone}};

}  // namespace

const SiteWords& words_of(SiteKind kind) {
  switch (kind) {
    case SiteKind::voltage_command:
      return kDriver;
    case SiteKind::winding_voltage:
      return kWinding;
    case SiteKind::shaft_torque:
      return kShaft;
    case SiteKind::pump_slip:
      return kPump;
    case SiteKind::line_drop:
      return kLine;
    case SiteKind::valve_crack:
      return kCrack;
    case SiteKind::outflow:
      return kOutflow;
    case SiteKind::compliance:
      return kCompliance;
    case SiteKind::seal_leakage:
      return kSeal;
    case SiteKind::piston_force:
      return kPiston;
    case SiteKind::inverse_modulus:
      return kModulus;
    case SiteKind::viscosity:
      return kViscosity;
    case SiteKind::tank_flow:
      return kTank;
    case SiteKind::own:
      return kOwn;
    case SiteKind::sensor_bias:
    case SiteKind::sensor_gain:
    case SiteKind::sensor_lag:
    case SiteKind::sensor_drift:
    case SiteKind::sensor_saturation:
      break;
    case SiteKind::input_gain:
    case SiteKind::input_bias:
    case SiteKind::input_delay:
    case SiteKind::input_clock_rate:
    case SiteKind::clock_rate:
      return kRecording;
  }
  return kSensor;
}

SiteWords words_at(const PlantDescription& plant, std::string_view element, SiteKind kind) {
  SiteWords words = words_of(kind);
  const auto site =
      std::ranges::find_if(plant.sites, [&](const Site& one) { return one.kind == kind && one.element == element; });
  if (kind != SiteKind::own || site == plant.sites.end()) return words;
  words.unit = site->unit;
  for (std::size_t k = 0; k < kSiteSignals; ++k)
    words.signals[k] = {site->signals[k].name, site->signals[k].unit, site->signals[k].name};
  return words;
}

MotionWords motion_of(SiteKind kind) {
  constexpr const char *kStill = "shaft at rest", *kForward = "turning forwards", *kBackward = "turning backwards",
                       *kTurning = "turning, both directions";
  switch (kind) {
    case SiteKind::piston_force:
      return {0, "at rest", "moving towards +x", "moving towards -x", "moving, both directions"};
    case SiteKind::seal_leakage:
      return {1, "at rest", "moving towards +x", "moving towards -x", "moving, both directions"};
    case SiteKind::shaft_torque:
      return {0, kStill, kForward, kBackward, kTurning};
    case SiteKind::pump_slip:
    case SiteKind::winding_voltage:
      return {1, kStill, kForward, kBackward, kTurning};
    case SiteKind::voltage_command:
      return {1, "without command", "positive command", "negative command", "commanded, both directions"};
    case SiteKind::line_drop:
      return {0, "without flow", "oil flowing into the chamber", "oil flowing out of the chamber",
              "oil flowing, both directions"};
    default:
      return {};
  }
}

}  // namespace sealwatch::mismatch

// What channels and parameters are to whoever watches an actuator, whatever a plant calls them. A plant's table gives the
// roles; who looks for a stroke or an area looks by role.
#pragma once

#include "sealwatch/core/fields.hpp"

namespace sealwatch {

/// What moves and how fast, where it should be, what drives it, the pressures that push the stroke up and down, the flow
/// that goes to the first of them.
SEALWATCH_ENUM(ChannelRole, none, stroke, speed, reference, drive, current, shaft_speed, shaft_angle, pressure_up,
               pressure_down, pressure_difference, flow, force, temperature)

/// The whole stroke; the cylinder's areas, pushing up and down or the second over the first; its dead volume and oil; the
/// leakage resistances of its seal and of the pump; the pump's displacement and viscous friction; resistance, torque
/// constant, voltage per speed and viscous friction of the motor.
SEALWATCH_ENUM(ParameterRole, none, stroke, area_up, area_down, area_ratio, dead_volume, bulk_modulus, seal_leakage,
               pump_leakage, displacement, pump_friction, motor_resistance, torque_constant, back_emf, motor_friction)

}  // namespace sealwatch

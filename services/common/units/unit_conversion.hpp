// Units as people write them, converted to a channel's SI unit by UDUNITS-2 (Unidata), which knows prefixes, powers and
// products: "kPa", "m3/h", "lbf", "degF", "in". Added to it is what process plants write: gpm, lpm, cfm; rev; counts; any
// pressure with g, (g) or gauge behind it (above the standard atmosphere, 101325 Pa), with a or abs, and with d or diff
// (a difference). Of a temperature C and F are degrees, no coulomb and no farad; of a force kg and lb are kgf and lbf.
//
//   value_SI = scale * value + offset
//
// An angle does not vanish: "Hz" or "1/s" is no angular speed, "rpm" and "deg/s" are; "1/min" is taken as rpm.
#pragma once

#include <string_view>

#include "sealwatch/core/result.hpp"
#include "sealwatch/core/units.hpp"

namespace sealwatch {

/// The conversion of `unit` to `si_unit`, both as text; an Error with a rule and units that would do otherwise. An
/// empty unit is the SI unit itself. May be called from any thread.
[[nodiscard]] Result<UnitConversion> convert_unit(std::string_view unit, std::string_view si_unit);

/// Whether `text` is a unit of anything.
[[nodiscard]] bool is_unit(std::string_view text);

}  // namespace sealwatch

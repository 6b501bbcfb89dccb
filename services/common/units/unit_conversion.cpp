#include "services/common/units/unit_conversion.hpp"

#include <udunits2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <mutex>
#include <string>

#include "sealwatch/core/process_copy.hpp"
#include "sealwatch/core/text.hpp"

namespace sealwatch {
namespace {

constexpr std::size_t kLongestUnit = 60;

struct FreeUnit {
  void operator()(ut_unit* unit) const { ut_free(unit); }
};
using Unit = std::unique_ptr<ut_unit, FreeUnit>;
struct FreeConverter {
  void operator()(cv_converter* converter) const { cv_free(converter); }
};

struct Addition {
  const char* name;
  const char* meaning;            ///< in UDUNITS' own words
  const char* si_unit = nullptr;  ///< only of a channel in this unit: elsewhere the name is another unit
};
constexpr std::array kAdditions = {
    Addition{"gpm", "3.785411784e-3 m3/min"},  // US gallon of 231 cubic inches
    Addition{"GPM", "3.785411784e-3 m3/min"}, Addition{"USgpm", "3.785411784e-3 m3/min"},
    Addition{"US gpm", "3.785411784e-3 m3/min"}, Addition{"gal/min", "3.785411784e-3 m3/min"}, Addition{"lpm", "L/min"},
    Addition{"LPM", "L/min"}, Addition{"cfm", "ft3/min"}, Addition{"PSI", "psi"},
    Addition{"mmH2O", "9.80665 Pa"},  // water of 1000 kg/m3
    Addition{"inH2O", "249.08891 Pa"}, Addition{"rev", "cycle"}, Addition{"deg", "arc_degree"}, Addition{"RPM", "rpm"},
    Addition{"U/min", "rpm"}, Addition{"tr/min", "rpm"}, Addition{"rev/min", "rpm"}, Addition{"Nm", "N m"},
    Addition{"VDC", "V"}, Addition{"HP", "hp"}, Addition{"counts", "1"}, Addition{"count", "1"}, Addition{"pct", "%"},
    // What loggers write, and UDUNITS takes for a charge, a capacitance, an angle or a mass.
    Addition{"C", "degC", "K"}, Addition{"F", "degF", "K"}, Addition{"deg C", "degC", "K"},
    Addition{"deg F", "degF", "K"}, Addition{"deg. C", "degC", "K"}, Addition{"deg. F", "degF", "K"},
    Addition{"Deg C", "degC", "K"}, Addition{"Deg F", "degF", "K"}, Addition{"DegC", "degC", "K"},
    Addition{"DegF", "degF", "K"}, Addition{"DEGC", "degC", "K"}, Addition{"DEGF", "degF", "K"},
    Addition{"Celsius", "degC", "K"}, Addition{"Fahrenheit", "degF", "K"}, Addition{"ºC", "degC", "K"},
    Addition{"ºF", "degF", "K"}, Addition{"kg/cm2", "kgf/cm2", "Pa"}, Addition{"kg/cm²", "kgf/cm2", "Pa"},
    // In capitals, as old loggers write: UDUNITS takes some for other units, MSEC for a million seconds.
    Addition{"MSEC", "ms", "s"}, Addition{"Msec", "ms", "s"}, Addition{"MS", "ms", "s"}, Addition{"mSec", "ms", "s"},
    Addition{"millis", "ms", "s"}, Addition{"micros", "us", "s"}, Addition{"nanos", "ns", "s"},
    Addition{"MM", "mm", "m"}, Addition{"CM", "cm", "m"}, Addition{"MM/S", "mm/s", "m/s"}, Addition{"BAR", "bar", "Pa"},
    Addition{"MBAR", "mbar", "Pa"}, Addition{"KPA", "kPa", "Pa"}, Addition{"MPA", "MPa", "Pa"},
    Addition{"PA", "Pa", "Pa"}, Addition{"KN", "kN", "N"}, Addition{"NM", "N m", "N m"},
    Addition{"L/MIN", "L/min", "m3/s"}, Addition{"MV", "mV", "V"}, Addition{"MA", "mA", "A"},
    Addition{"AMPS", "A", "A"}, Addition{"VOLTS", "V", "V"}, Addition{"lb", "lbf", "N"}, Addition{"lbs", "lbf", "N"},
    Addition{"kg", "kgf", "N"}, Addition{"ft-lb", "ft lbf", "N m"}, Addition{"lb-ft", "ft lbf", "N m"},
    Addition{"in-lb", "in lbf", "N m"},
    // Samples a second; UDUNITS' S is siemens.
    Addition{"S/s", "Hz", "Hz"}, Addition{"kS/s", "kHz", "Hz"}, Addition{"MS/s", "MHz", "Hz"},
    Addition{"Sa/s", "Hz", "Hz"}, Addition{"kSa/s", "kHz", "Hz"}, Addition{"MSa/s", "MHz", "Hz"},
    Addition{"samples/s", "Hz", "Hz"}, Addition{"sps", "Hz", "Hz"},
    // Of an angular speed, what has no angle counts revolutions: nobody logs radians a minute.
    Addition{"1/min", "rpm", "rad/s"}, Addition{"min-1", "rpm", "rad/s"}, Addition{"min^-1", "rpm", "rad/s"},
    Addition{"/min", "rpm", "rad/s"}, Addition{"min⁻¹", "rpm", "rad/s"}};

constexpr double kAtmosphere_Pa = 101325.0;

/// A unit of pressure and what it is measured from: "psig", "bar (g)", "kPa abs", "psid".
struct Qualified {
  std::string_view unit;  ///< without it; empty: nothing of that kind stands there
  bool gauge = false;
};

Qualified split_qualifier(std::string_view text) {
  const bool in_brackets = text.ends_with(')');
  if (in_brackets) text.remove_suffix(1);
  for (const std::string_view word : {"gauge", "abs", "diff", "g", "a", "d", "G", "A", "D"}) {
    if (!text.ends_with(word)) continue;
    std::string_view unit = text.substr(0, text.size() - word.size());
    if (in_brackets != unit.ends_with('(')) return {};
    if (in_brackets) unit.remove_suffix(1);
    while (unit.ends_with(' ')) unit.remove_suffix(1);
    return {.unit = unit, .gauge = word.front() == 'g' || word == "G"};
  }
  return {};
}

/// UDUNITS keeps its errors and its parser in one place for the whole process.
FreeInCopies one_at_a_time;

/// Made and used under `one_at_a_time`.
class UnitSystem {
 public:
  static UnitSystem& get() {
    static UnitSystem system;
    return system;
  }

  /// The unit of a channel in `si_unit`, of any where that is empty; nothing where the text is no unit.
  [[nodiscard]] Unit parse(std::string_view text, std::string_view si_unit = {}) const {
    if (system_ == nullptr || text.empty() || text.size() > kLongestUnit) return nullptr;
    const Qualified qualified = split_qualifier(text);
    if (const Unit unit = parse_plain(qualified.unit, si_unit); unit && ut_are_convertible(unit.get(), pascal_) != 0)
      return qualified.gauge ? above_atmosphere(*unit) : Unit(ut_clone(unit.get()));
    return parse_plain(text, si_unit);
  }

 private:
  UnitSystem() {
    ut_set_error_message_handler(&ut_ignore);
    system_ = ut_read_xml(nullptr);
    if (system_ == nullptr) return;
    pascal_ = ut_get_unit_by_name(system_, "pascal");
    for (const Addition& added : kAdditions) {
      const std::string_view name = added.name;
      const bool anywhere = added.si_unit == nullptr && name.find_first_of("/ ") == std::string_view::npos;
      const Unit meaning = anywhere ? parse_plain(name, {}) : nullptr;
      if (meaning) ut_map_name_to_unit(added.name, UT_ASCII, meaning.get());  // "deg/s" as well
    }
  }

  [[nodiscard]] Unit parse_plain(std::string_view text, std::string_view si_unit) const {
    if (text.empty()) return nullptr;
    for (const Addition& added : kAdditions)  // the library would take those with a slash apart
      if (text == added.name && (added.si_unit == nullptr || si_unit == added.si_unit)) text = added.meaning;
    const std::string terminated(text);
    return Unit(ut_parse(system_, terminated.c_str(), UT_UTF8));
  }

  [[nodiscard]] Unit above_atmosphere(ut_unit& unit) const {
    const std::unique_ptr<cv_converter, FreeConverter> from_pascal(ut_get_converter(pascal_, &unit));
    return from_pascal ? Unit(ut_offset(&unit, cv_convert_double(from_pascal.get(), kAtmosphere_Pa))) : nullptr;
  }

  ut_system* system_;          ///< as long as the process: never freed
  ut_unit* pascal_ = nullptr;  ///< as long
};

bool has_angle(const ut_unit& unit) {
  std::array<char, 256> text{};
  const int length = ut_format(&unit, text.data(), text.size(), UT_ASCII | UT_NAMES | UT_DEFINITION);
  return length > 0 && std::string_view(text.data()).find("radian") != std::string_view::npos;
}

/// UDUNITS also converts a period to its frequency and an angle to a plain number: not meant here.
bool same_dimension(const ut_unit& a, const ut_unit& b) {
  const Unit ratio(ut_divide(&a, &b));
  return ratio && ut_are_convertible(&a, &b) != 0 && ut_is_dimensionless(ratio.get()) != 0 &&
         has_angle(a) == has_angle(b);
}

std::string units_in_words(std::string_view si_unit) {
  std::string units = "units of this channel: ";
  for (const std::string& name : units_of(si_unit)) units.append(name == si_unit ? "" : ", ").append(name);
  return units;
}

/// Of a unit that is another quantity's: why, and what to write.
tl::unexpected<Error> other_quantity(const UnitSystem& system, std::string_view unit, const ut_unit& from,
                                     std::string_view si_unit) {
  const std::string si(si_unit);
  if (unit == "%") return fail("is a share, not " + si, "in the map: unit: " + si + ", and as scale what 1 % is");
  if (unit == "counts" || unit == "count")
    return fail("are a plain number, not " + si,
                "in the map: unit: " + si + ", scale: what one count is, offset: what no count is");
  const Unit frequency = si_unit == "rad/s" ? system.parse("1/s") : nullptr;
  if (frequency && same_dimension(from, *frequency))
    return fail("cannot be converted to rad/s", "where it counts revolutions: rev/min (rpm) or rev/s");
  return fail("cannot be converted to " + si, units_in_words(si_unit));
}

Result<UnitConversion> from_library(std::string_view unit, std::string_view si_unit) {
  const std::scoped_lock lock(one_at_a_time);
  const UnitSystem& system = UnitSystem::get();
  const Unit from = system.parse(unit, si_unit);
  const Unit to = system.parse(si_unit);
  if (!from) {
    const std::string meant = nearest(unit, units_of(si_unit));
    return fail("is not a known unit", meant.empty() ? units_in_words(si_unit) : "did you mean '" + meant + "'?");
  }
  if (!to || !same_dimension(*from, *to)) return other_quantity(system, unit, *from, si_unit);
  const std::unique_ptr<cv_converter, FreeConverter> converter(ut_get_converter(from.get(), to.get()));
  if (!converter) return fail("cannot be converted to " + std::string(si_unit));
  const double offset = cv_convert_double(converter.get(), 0.0);
  return UnitConversion{.scale = cv_convert_double(converter.get(), 1.0) - offset, .offset = offset, .si_unit = {}};
}

}  // namespace

Result<UnitConversion> convert_unit(std::string_view unit, std::string_view si_unit) {
  if (unit.empty() || unit == si_unit) return UnitConversion{.scale = 1.0, .offset = 0.0, .si_unit = {}};
  if (unit.size() > kLongestUnit) return fail("is not a known unit");
  const Result<UnitConversion> known = find_unit(unit);  // exact definitions of the usual ones, without the library
  return known && known->si_unit == si_unit ? known : from_library(unit, si_unit);
}

bool is_unit(std::string_view text) {
  if (text.empty() || find_unit(text)) return !text.empty();
  const std::scoped_lock lock(one_at_a_time);
  const UnitSystem& system = UnitSystem::get();
  return system.parse(text) != nullptr;
}

}  // namespace sealwatch

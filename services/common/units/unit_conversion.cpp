#include "services/common/units/unit_conversion.hpp"

#include <udunits2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <mutex>
#include <string>

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
  const char* meaning;  ///< in UDUNITS' own words
};
constexpr std::array kAdditions = {Addition{"gpm", "3.785411784e-3 m3/min"},  // US gallon of 231 cubic inches
                                   Addition{"GPM", "3.785411784e-3 m3/min"},
                                   Addition{"gal/min", "3.785411784e-3 m3/min"},
                                   Addition{"lpm", "L/min"},
                                   Addition{"LPM", "L/min"},
                                   Addition{"cfm", "ft3/min"},
                                   Addition{"barg", "bar @ 1.01325"},
                                   Addition{"bara", "bar"},
                                   Addition{"psig", "psi @ 14.695948775513"},
                                   Addition{"psia", "psi"},
                                   Addition{"PSI", "psi"},
                                   Addition{"PSIG", "psi @ 14.695948775513"},
                                   Addition{"kPag", "kPa @ 101.325"},
                                   Addition{"MPag", "MPa @ 0.101325"},
                                   Addition{"rev", "cycle"},
                                   Addition{"deg", "arc_degree"},
                                   Addition{"RPM", "rpm"},
                                   Addition{"U/min", "rpm"},
                                   Addition{"rev/min", "rpm"},
                                   Addition{"Nm", "N m"},
                                   Addition{"counts", "1"},
                                   Addition{"count", "1"}};

/// What loggers write for a temperature, which UDUNITS takes for a charge, a capacitance or an angle with them.
constexpr std::array kTemperatures = {
    Addition{"C", "degC"},       Addition{"F", "degF"},         Addition{"deg C", "degC"}, Addition{"deg F", "degF"},
    Addition{"deg. C", "degC"},  Addition{"deg. F", "degF"},    Addition{"Deg C", "degC"}, Addition{"Deg F", "degF"},
    Addition{"DegC", "degC"},    Addition{"DegF", "degF"},      Addition{"DEGC", "degC"},  Addition{"DEGF", "degF"},
    Addition{"Celsius", "degC"}, Addition{"Fahrenheit", "degF"}};

std::string_view temperature_meant(std::string_view unit, std::string_view si_unit) {
  const auto* found =
      std::ranges::find(kTemperatures, unit, [](const Addition& one) { return std::string_view(one.name); });
  return si_unit == "K" && found != kTemperatures.end() ? std::string_view(found->meaning) : unit;
}

/// UDUNITS keeps its errors and its parser in one place for the whole process: under `mutex`.
class UnitSystem {
 public:
  static UnitSystem& get() {
    static UnitSystem system;
    return system;
  }

  std::mutex mutex;

  /// Nothing where the text is no unit.
  [[nodiscard]] Unit parse(std::string_view text) const {
    if (system_ == nullptr || text.empty() || text.size() > kLongestUnit) return nullptr;
    for (const Addition& added : kAdditions)  // the library would take those with a slash apart
      if (text == added.name) text = added.meaning;
    const std::string terminated(text);
    return Unit(ut_parse(system_, terminated.c_str(), UT_UTF8));
  }

 private:
  UnitSystem() {
    // A copy of the process (runtime/trial.cpp) has no thread that would unlock it.
    pthread_atfork([] { get().mutex.lock(); }, [] { get().mutex.unlock(); }, [] { get().mutex.unlock(); });
    ut_set_error_message_handler(&ut_ignore);
    system_ = ut_read_xml(nullptr);
    for (const Addition& added : kAdditions) {
      const std::string_view name = added.name;
      const Unit meaning = name.find('/') == std::string_view::npos ? parse(name) : nullptr;
      if (meaning) ut_map_name_to_unit(added.name, UT_ASCII, meaning.get());  // "deg/s" as well
    }
  }
  ut_system* system_;  ///< as long as the process: never freed
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
  std::string units;
  for (const std::string& name : units_of(si_unit)) units.append(units.empty() ? "" : ", ").append(name);
  return units;
}

Result<UnitConversion> from_library(std::string_view unit, std::string_view si_unit) {
  UnitSystem& system = UnitSystem::get();
  const std::lock_guard<std::mutex> lock(system.mutex);
  const Unit from = system.parse(unit);
  const Unit to = system.parse(si_unit);
  if (!from) return fail("is not a known unit");
  if (unit == "%" && si_unit != "1")
    return fail("is a share and no " + std::string(si_unit),
                "in the map: unit: " + std::string(si_unit) + ", and as scale what 1 % is");
  if (!to || !same_dimension(*from, *to))
    return fail("cannot be converted to " + std::string(si_unit), "units of this channel: " + units_in_words(si_unit));
  const std::unique_ptr<cv_converter, FreeConverter> converter(ut_get_converter(from.get(), to.get()));
  if (!converter) return fail("cannot be converted to " + std::string(si_unit));
  const double offset = cv_convert_double(converter.get(), 0.0);
  return UnitConversion{.scale = cv_convert_double(converter.get(), 1.0) - offset, .offset = offset, .si_unit = {}};
}

}  // namespace

Result<UnitConversion> convert_unit(std::string_view unit, std::string_view si_unit) {
  if (unit.empty() || unit == si_unit) return UnitConversion{.scale = 1.0, .offset = 0.0, .si_unit = {}};
  if (unit.size() > kLongestUnit) return fail("is not a known unit");
  unit = temperature_meant(unit, si_unit);
  Result<UnitConversion> known = find_unit(unit);  // exact definitions of the usual ones, without the library
  if (known && known->si_unit == si_unit) return known;
  Result<UnitConversion> converted = from_library(unit, si_unit);
  if (!converted && !known && converted.error().rule == "is not a known unit") return known;  // with the nearest name
  return converted;
}

bool is_unit(std::string_view text) {
  if (text.empty() || find_unit(text)) return !text.empty();
  UnitSystem& system = UnitSystem::get();
  const std::lock_guard<std::mutex> lock(system.mutex);
  return system.parse(text) != nullptr;
}

}  // namespace sealwatch

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <utility>

#include "services/common/equations/dimension.hpp"
#include "services/common/fmi/model_description.hpp"
#include "services/common/text/words.hpp"
#include "services/common/units/unit_conversion.hpp"

namespace sealwatch::fmi {
namespace {

struct KnownUnit {
  BaseExponents exponents;  // kg m s A K mol cd rad
  const char* name;
};

/// As recordings and plants write them (sealwatch/core/units.hpp). The radian is a plain number where it is not alone
/// with the second.
constexpr std::array kKnown = {
    KnownUnit{{0, 0, 0, 0, 0, 0, 0, 0}, "1"},          KnownUnit{{1, 0, 0, 0, 0, 0, 0, 0}, "kg"},
    KnownUnit{{0, 1, 0, 0, 0, 0, 0, 0}, "m"},          KnownUnit{{0, 2, 0, 0, 0, 0, 0, 0}, "m2"},
    KnownUnit{{0, 3, 0, 0, 0, 0, 0, 0}, "m3"},         KnownUnit{{0, 0, 1, 0, 0, 0, 0, 0}, "s"},
    KnownUnit{{0, 0, -1, 0, 0, 0, 0, 0}, "1/s"},       KnownUnit{{0, 1, -1, 0, 0, 0, 0, 0}, "m/s"},
    KnownUnit{{0, 1, -2, 0, 0, 0, 0, 0}, "m/s2"},      KnownUnit{{0, 3, -1, 0, 0, 0, 0, 0}, "m3/s"},
    KnownUnit{{0, 0, 0, 1, 0, 0, 0, 0}, "A"},          KnownUnit{{0, 0, 0, 0, 1, 0, 0, 0}, "K"},
    KnownUnit{{0, 0, 0, 0, 0, 0, 0, 1}, "rad"},        KnownUnit{{0, 0, -1, 0, 0, 0, 0, 1}, "rad/s"},
    KnownUnit{{0, 0, -2, 0, 0, 0, 0, 1}, "rad/s2"},    KnownUnit{{1, 1, -2, 0, 0, 0, 0, 0}, "N"},
    KnownUnit{{1, 2, -2, 0, 0, 0, 0, 0}, "N m"},       KnownUnit{{1, -1, -2, 0, 0, 0, 0, 0}, "Pa"},
    KnownUnit{{1, 2, -3, 0, 0, 0, 0, 0}, "W"},         KnownUnit{{1, 2, -3, -1, 0, 0, 0, 0}, "V"},
    KnownUnit{{1, 2, -3, -2, 0, 0, 0, 0}, "ohm"},      KnownUnit{{1, 2, -2, -2, 0, 0, 0, 0}, "H"},
    KnownUnit{{1, 0, -1, 0, 0, 0, 0, 0}, "N s/m"},     KnownUnit{{1, 0, -2, 0, 0, 0, 0, 0}, "N/m"},
    KnownUnit{{1, -3, 0, 0, 0, 0, 0, 0}, "kg/m3"},     KnownUnit{{1, 2, 0, 0, 0, 0, 0, 0}, "kg m2"},
    KnownUnit{{-1, 4, 1, 0, 0, 0, 0, 0}, "m3/(s Pa)"}, KnownUnit{{1, -1, -1, 0, 0, 0, 0, 0}, "Pa s"},
    KnownUnit{{1, -4, -1, 0, 0, 0, 0, 0}, "Pa s/m3"}};

/// "kg m2": the base units with an exponent of this sign, the second last, as in "N m s".
std::string product(const BaseExponents& exponents, int sign) {
  constexpr std::array kBase = {"kg", "m", "s", "A", "K", "mol", "cd", "rad"};
  std::ostringstream text;
  const char* between = "";
  for (const std::size_t k : {0, 1, 3, 4, 5, 6, 7, 2}) {
    const int exponent = sign * exponents[k];
    if (exponent <= 0) continue;
    text << between << kBase[k];
    if (exponent > 1) text << exponent;
    between = " ";
  }
  return text.str();
}

/// Some tools leave the radian out of the base units of angles. The unit's own name tells; nothing where it is no angle.
const char* angular_name(const Unit& unit) {
  BaseExponents with_radian = unit.exponents;
  if (unit.name.empty() || unit.offset != 0.0 || std::exchange(with_radian.back(), 1) != 0) return nullptr;
  const auto known = std::ranges::find(kKnown, with_radian, &KnownUnit::exponents);
  if (known == kKnown.end()) return nullptr;
  constexpr double kRounding = 1e-6;  // of a factor that was written down
  const Result<UnitConversion> angular = convert_unit(unit.name, known->name);
  return angular && std::abs(angular->scale / unit.factor - 1.0) < kRounding ? known->name : nullptr;
}

}  // namespace

namespace {

/// "bar (p_1, p_2), min (tau)"
std::string listed(std::map<std::string, std::vector<std::string>> uses) {
  constexpr std::size_t kMostNamed = 4, kMostUnits = 10;
  std::string list;
  std::size_t units = 0;
  for (auto& [unit, names] : uses) {
    if (++units > kMostUnits) break;
    const std::size_t more = names.size() - std::min(names.size(), kMostNamed);
    names.resize(names.size() - more);
    if (more > 0) names.push_back(std::to_string(more) + " more");
    text::add_to_list(list, unit + " (" + text::joined(names) + ")");
  }
  return list + (uses.size() > kMostUnits ? " and " + std::to_string(uses.size() - kMostUnits) + " more" : "");
}

}  // namespace

std::string undefined_units(const ModelDescription& description, const std::vector<std::size_t>& variables) {
  std::map<std::string, std::vector<std::string>> uses;
  for (const std::size_t k : variables) {
    const Variable& variable = description.variables[k];
    if (!variable.unit.empty() && variable.unit != "-" && !description.si_unit_of(variable))
      uses[variable.unit].push_back(variable.name);
  }
  return listed(std::move(uses));
}

std::string units_by_name(const ModelDescription& description, const std::vector<std::size_t>& variables) {
  std::map<std::string, std::vector<std::string>> uses;
  for (const std::size_t k : variables)
    if (const Unit* unit = description.find_unit(description.variables[k].unit);
        unit != nullptr && !unit->has_base && unit->by_name && unit->name != "1")
      uses[unit->name].push_back(description.variables[k].name);
  return listed(std::move(uses));
}

// The angle is kept where the known names keep it. What is a unit of SI with its prefix is that, whatever logs mean by
// the same letters: MA are a million amperes, C a coulomb.
std::optional<SiUnit> unit_by_name(const std::string& name) {
  std::optional<SiUnit> known;
  if (name.empty() || name == "-") return known;
  for (auto unit = kKnown.begin(); !known && unit != kKnown.end(); ++unit)
    if (const auto found = convert_unit(name, unit->name)) known = SiUnit{unit->name, {found->scale, found->offset}};
  const Result<equations::Dimension> own = equations::find_dimension(name);
  if (!own) return known;
  constexpr double kRounding = 1e-9;
  const auto there = known ? equations::find_dimension(known->name) : own;
  const bool same = known && there && *own == *there && known->conversion.offset == 0.0 &&
                    std::abs(known->conversion.factor / own->scale - 1.0) < kRounding;
  if (same) return known;
  equations::Dimension si = *own;
  si.scale = 1.0;
  return SiUnit{equations::words_of(si), {own->scale, 0.0}};
}

std::string si_name(const Unit& unit) {
  if (!unit.has_base) return "1";
  if (const char* angular = angular_name(unit)) return angular;
  const auto known = std::ranges::find(kKnown, unit.exponents, &KnownUnit::exponents);
  if (known != kKnown.end()) return known->name;
  const std::string above = product(unit.exponents, 1), below = product(unit.exponents, -1);
  std::ostringstream text;
  text << (above.empty() ? "1" : above);
  if (below.find(' ') != std::string::npos)
    text << "/(" << below << ")";
  else if (!below.empty())
    text << "/" << below;
  return text.str();
}

}  // namespace sealwatch::fmi

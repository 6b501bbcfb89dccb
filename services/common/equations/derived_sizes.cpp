#include "services/common/equations/derived_sizes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "sealwatch/model/physics.hpp"

namespace sealwatch::equations {
namespace {

struct Factor {
  std::string_view unit;
  double power;
};
struct Rule {
  std::string_view unit;
  std::array<Factor, 3> factors;
};

constexpr std::array kRules = {
    Rule{"N/m", {{{"N", 1}, {"m", -1}}}},
    Rule{"N/m2", {{{"N", 1}, {"m", -2}}}},
    Rule{"N s2/m2", {{{"N s/m", 2}, {"N", -1}}}},  // at the speed at which viscous friction is as large as the force
    Rule{"m2", {{{"N", 1}, {"Pa", -1}}}},          // friction by pressure
    Rule{"N m/A", {{{"N m", 1}, {"A", -1}}}},
    Rule{"N m/A3", {{{"N m", 1}, {"A", -3}}}},
    Rule{"Pa s/m3", {{{"Pa", 1}, {"m3/s", -1}}}},
    Rule{"Pa s2/m6", {{{"Pa", 1}, {"m3/s", -2}}}},
    Rule{"m3/(s Pa)", {{{"m3/s", 1}, {"Pa", -1}}}},
    Rule{"m3/(s Pa^0.5)", {{{"m3/s", 1}, {"Pa", -0.5}}}},
    Rule{"m3/rad", {{{"m3/s", 1}, {"rad/s", -1}}}},
    Rule{"m3 s/rad2", {{{"m3/s", 1}, {"rad/s", -2}}}},
    Rule{"m3/(rad Pa)", {{{"m3/s", 1}, {"rad/s", -1}, {"Pa", -1}}}},
    Rule{"ohm", {{{"V", 1}, {"A", -1}}}},
    Rule{"ohm/A2", {{{"V", 1}, {"A", -3}}}},
    Rule{"1/s", {{{"V/s", 1}, {"V", -1}}}},
    Rule{"V^0.5/s", {{{"V/s", 1}, {"V", -0.5}}}},
    // What only widths of corners are measured in, and so may not be given.
    Rule{"Pa", {{{"m3/s", 1}, {"m3/(s Pa)", -1}}}},
    Rule{"Pa", {{{"N", 1}, {"m2", -1}}}},
    Rule{"Pa", {{{"N m", 1}, {"m3/rad", -1}}}},
    Rule{"m3/s", {{{"Pa", 1}, {"Pa s/m3", -1}}}},
    Rule{"A", {{{"ohm", 0.5}, {"ohm/A2", -0.5}}}},
};

}  // namespace

std::vector<std::string> sources_of_size(std::string_view unit) {
  std::vector<std::string> sources;
  for (const Rule& rule : kRules)
    for (const Factor& factor : rule.factors)
      if (rule.unit == unit && !factor.unit.empty()) sources.emplace_back(factor.unit);
  return sources;
}

void add_derived_sizes(std::map<std::string, double>& sizes) {
  for (std::size_t before = 0; before != sizes.size();) {  // what was derived lets more be derived
    before = sizes.size();
    for (const Rule& rule : kRules) {
      double size = 1.0;
      for (const Factor& factor : rule.factors) {
        if (factor.unit.empty()) continue;
        const auto given = sizes.find(std::string(factor.unit));
        size = given == sizes.end() ? 0.0 : size * std::pow(given->second, factor.power);
      }
      if (size > 0.0) sizes.try_emplace(std::string(rule.unit), size);
    }
  }
}

std::vector<std::string> units_of_sizes() {
  std::set<std::string> units;
  for (const Law& law : all_laws()) {
    for (const LawParameter& parameter : law.parameters) units.emplace(parameter.unit);
    for (const auto& rounding : law.roundings) units.emplace(rounding.unit);
  }
  for (const Rule& rule : kRules) {
    units.emplace(rule.unit);
    for (const Factor& factor : rule.factors) units.emplace(factor.unit);
  }
  for (const char* none : {"", "channel"}) units.erase(none);
  return {units.begin(), units.end()};
}

std::vector<std::string> sizes_to_give(const std::map<std::string, double>& given, std::vector<std::string> needed) {
  std::erase_if(needed, [&](const std::string& unit) { return given.contains(unit); });
  std::vector<std::string> units;  // those first that usually follow from others
  for (const Rule& rule : kRules)
    if (std::ranges::find(units, rule.unit) == units.end()) units.emplace_back(rule.unit);
  for (const std::string& unit : units) {
    std::map<std::string, double> sizes = given;
    for (const std::string& other : needed)
      if (other != unit) sizes.try_emplace(other, 1.0);
    add_derived_sizes(sizes);
    if (sizes.contains(unit)) std::erase(needed, unit);
  }
  return needed;
}

}  // namespace sealwatch::equations

#include "services/common/equations/reference_quantity.hpp"

#include <algorithm>
#include <map>
#include <string_view>
#include <tuple>

#include "sealwatch/model/law_references.hpp"
#include "services/common/equations/derived_sizes.hpp"
#include "services/common/equations/site_table.hpp"
#include "services/common/text/format.hpp"
#include "services/common/text/numbers.hpp"

namespace sealwatch::equations {
namespace {

/// The usual value of the signal in a unit at a kind of site.
double usual_signal(SiteKind kind, std::string_view unit) {
  const auto& signals = names_of_site(kind).signals;
  const auto* const signal = std::ranges::find(signals, unit, &SignalName::unit);
  return signal == signals.end() ? 0.0 : signal->usual;
}

std::map<std::string, ReferenceQuantity> told_by_actuator() {
  std::map<std::string, ReferenceQuantity> told;
  for (const auto& [kind, unit, meaning] : {std::tuple{SiteKind::piston_force, "m/s", "speed of its piston"},
                                            {SiteKind::shaft_torque, "rad/s", "speed of its shaft"},
                                            {SiteKind::winding_voltage, "A", "current in its winding"},
                                            {SiteKind::voltage_command, "V", "command to its drive"},
                                            {SiteKind::outflow, "Pa", "pressure in its chambers"},
                                            {SiteKind::line_drop, "m3/s", "flow to its cylinder"}})
    told[unit] = {usual_signal(kind, unit), meaning};
  for (const LawReference& one : law_references()) told[std::string(one.unit)] = {one.value, one.meaning};
  return told;
}

}  // namespace

ReferenceQuantity reference_quantity(const NeededSize& size, const std::vector<TextSite>& sites) {
  const bool tank = std::ranges::any_of(sites, [](const TextSite& site) { return site.kind == SiteKind::tank_flow; });
  if (tank && size.unit == "V") return {usual_signal(SiteKind::tank_flow, "V"), "level of a tank"};
  const std::map<std::string, ReferenceQuantity> told = told_by_actuator();
  if (const auto known = told.find(size.unit); known != told.end()) return known->second;
  std::map<std::string, double> values;
  for (const auto& [unit, quantity] : told) values.emplace(unit, quantity.value);
  add_derived_sizes(values);
  if (const auto derived = values.find(size.unit); !tank && derived != values.end()) {
    std::string from;
    for (const std::string& source : sources_of_size(size.unit))
      from.append(from.empty() ? "from its " : " and ").append(source);
    return {derived->second, from};
  }
  return {size.parameter->start.front(),
          "usual " + std::string(size.parameter->name) + " of " + std::string(size.law->id)};
}

std::string in_words(const ReferenceQuantity& quantity, const std::string& unit) {
  return text::format("about {} {} ({})", text::number(quantity.value), unit, quantity.meaning);
}

}  // namespace sealwatch::equations

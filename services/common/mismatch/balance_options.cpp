#include "services/common/mismatch/balance_options.hpp"

#include <algorithm>

#include "sealwatch/model/law_sizes.hpp"
#include "services/common/mismatch/candidates.hpp"

namespace sealwatch::mismatch {
namespace {

BalanceUnknown datasheet_unknown(const AssetConfig& asset, const DatasheetValue& value) {
  const ParameterSetting& setting = asset.parameters.at(std::string(value.name));
  const bool bounded = setting.estimate && setting.max > setting.min;
  return {.name = std::string(value.name),
          .element = std::string(value.element),
          .logarithmic = true,
          .min = bounded ? setting.min : setting.value / value.off_by_at_most,
          .max = bounded ? setting.max : setting.value * value.off_by_at_most};
}

bool tried_with_balances(const Law& law, const PlantDescription& plant) {
  if (law.closed_form || law.hidden || law.id == "constant_force") return false;
  if (law.evaluate == nullptr) return law.kind == SiteKind::sensor_bias || law.kind == SiteKind::sensor_gain;
  return strengths_of(law).size() == 1 && plant.has_load();
}

PhysicsTerm absent(const Law& law, const std::string& element, const PlantDescription& plant) {
  PhysicsTerm term{.id = std::string(law.id), .element = element, .parameters = {}};
  for (const LawParameter& parameter : law.parameters) {
    const LawBounds bounds = law_bounds(plant, parameter);
    term.parameters[std::string(parameter.name)] = {.value = parameter.strength ? 0.0 : law_start(plant, parameter),
                                                    .min = bounds.min,
                                                    .max = bounds.max,
                                                    .estimate = parameter.strength};
  }
  return term;
}

BalanceOption law_option(const Law& law, const std::string& element, const PlantDescription& plant, double range) {
  const LawParameter& strength = law.parameters[strengths_of(law).front()];
  const LawBounds bounds = law_bounds(plant, strength);
  const bool bias = law.kind == SiteKind::sensor_bias;
  return {.unknown = {.name = std::string(strength.name),
                      .element = element,
                      .law = &law,
                      .unit = bias ? 0.01 * range : law_size(plant, strength) * strength.start.front(),
                      .min = bounds.min,
                      .max = bounds.max},
          .term = absent(law, element, plant)};
}

}  // namespace

bool same_law(const BalanceUnknown& a, const BalanceUnknown& b) {
  return a.law != nullptr && b.law != nullptr && a.law->id == b.law->id && a.element == b.element;
}

std::vector<BalanceUnknown> free_unknowns(const AssetConfig& asset, std::size_t recordings) {
  std::vector<BalanceUnknown> unknowns;
  for (const DatasheetValue& value : SwitchedBalances::kDatasheet)
    if (asset.parameters.at(std::string(value.name)).estimate) unknowns.push_back(datasheet_unknown(asset, value));
  for (std::size_t k = 0; k < recordings; ++k)
    unknowns.push_back({.name = "load_factor", .recording = k, .min = -1e3, .max = 1e3});
  return unknowns;
}

std::vector<BalanceOption> balance_options(const AssetConfig& asset, const PlantDescription& plant) {
  std::vector<BalanceOption> options;
  for (const DatasheetValue& value : SwitchedBalances::kDatasheet)
    if (!asset.parameters.at(std::string(value.name)).estimate)
      options.push_back({.unknown = datasheet_unknown(asset, value), .term = {}});
  for (const Law& law : all_laws()) {
    if (!tried_with_balances(law, plant)) continue;
    std::string last;
    for (const Site& site : plant.sites) {
      const std::string element(site.element);
      if (law.evaluate == nullptr || !fits(law, site) || element == last) continue;
      options.push_back(law_option(law, last = element, plant, 0.0));
      options.back().places = std::ranges::count_if(
          plant.sites, [&](const Site& other) { return other.element == site.element && other.kind == law.kind; });
    }
    if (law.evaluate != nullptr) continue;
    // Sensors that another one measures too. An error of a pressure or of the position cannot be told from a load,
    // friction or an area by balances that rest on it.
    for (const std::string_view name : SwitchedBalances::kCompared)
      if (const ChannelDescription* channel = plant.find_channel(name);
          channel != nullptr && (law.kind != SiteKind::sensor_bias || channel->range_max > channel->range_min))
        options.push_back(law_option(law, "sensor:" + channel->name, plant, channel->range_max - channel->range_min));
  }
  return options;
}

}  // namespace sealwatch::mismatch

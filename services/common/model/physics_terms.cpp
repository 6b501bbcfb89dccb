#include "services/common/model/physics_terms.hpp"

#include <algorithm>

#include "sealwatch/core/text.hpp"
#include "sealwatch/model/law_sizes.hpp"

namespace sealwatch {
namespace {

tl::unexpected<Error> misplaced(const AssetConfig& asset, const PhysicsTerm& term, std::string rule,
                                std::string advice = {}) {
  return fail(Error{.file = {},
                    .place = "asset " + asset.asset_id + ", key physics",
                    .value = term.id + " at " + term.element,
                    .rule = std::move(rule),
                    .advice = std::move(advice)});
}

void add_parameters(PhysicsTerms& terms, const Law& law, const PhysicsTerm& term) {
  for (const LawParameter& parameter : law.parameters)
    terms.parameters.push_back({.name = physics_parameter_name(term.element, term.id, parameter.name),
                                .law = &law,
                                .parameter = &parameter,
                                .setting = term.parameters.at(std::string(parameter.name))});
}

/// "flow" of "sensor:flow", where the plant has such a channel; "" otherwise.
std::string channel_at(const PlantDescription& plant, std::string_view prefix, std::string_view element) {
  if (!element.starts_with(prefix)) return {};
  std::string channel(element.substr(prefix.size()));
  return plant.find_channel(channel) == nullptr ? std::string() : channel;
}

}  // namespace

std::string physics_parameter_name(std::string_view element, std::string_view id, std::string_view parameter) {
  std::string name(element);
  name.append(".").append(id).append(".").append(parameter);
  return name;
}

Result<PhysicsTerms> resolve_physics(const PlantDescription& plant, std::span<const Site> sites,
                                     const AssetConfig& asset) {
  PhysicsTerms terms;
  for (const PhysicsTerm& term : asset.physics) {
    std::vector<std::string> names;
    for (const auto& [name, setting] : term.parameters) names.push_back(name);
    const Result<const Law*> law = find_law(term.id, names, plant.name);
    if (!law) return misplaced(asset, term, law.error().rule, law.error().advice);
    const std::size_t first = plant.parameters.size() + terms.parameters.size();
    if (is_sensor((*law)->kind)) {
      const std::string channel = channel_at(plant, "sensor:", term.element);
      if (channel.empty())
        return misplaced(asset, term, "is a law of a sensor", "give the element as sensor:<channel>");
      terms.sensors.push_back({(*law)->kind, channel, first});
    } else if (is_of_recording((*law)->kind)) {
      const bool clock = (*law)->kind == SiteKind::clock_rate;
      const std::string input = channel_at(plant, "input:", term.element);
      if (clock ? term.element != "clock" : input.empty())
        return misplaced(asset, term, clock ? "is a law of the recording's clock" : "is a law of a recorded input",
                         clock ? "give the element as clock" : "give the element as input:<channel>");
      terms.recording.push_back({(*law)->kind, input, first});
    } else {
      ActiveTerm active{.law = *law, .sites = {}, .first_parameter = first, .roundings = roundings_of(plant, **law)};
      for (std::size_t k = 0; k < sites.size(); ++k)
        if (sites[k].element == term.element && sites[k].kind == (*law)->kind) active.sites.push_back(k);
      if (active.sites.empty())
        return misplaced(asset, term, "does not fit this element of " + plant.name,
                         "its kind of site is " + std::string(name_of((*law)->kind)));
      if ((*law)->hidden) {
        if (terms.hidden_names.size() == kMaximumHiddenStates)
          return misplaced(asset, term, "is one law with a hidden state too many",
                           "at most " + std::to_string(kMaximumHiddenStates) + " can be simulated together");
        active.hidden = static_cast<int>(terms.hidden_names.size());
        terms.hidden_names.push_back(physics_parameter_name(term.element, term.id, (*law)->hidden->name));
        terms.hidden_scales.push_back((*law)->hidden->scale);
      }
      terms.active.push_back(std::move(active));
    }
    add_parameters(terms, **law, term);
  }
  return terms;
}

}  // namespace sealwatch

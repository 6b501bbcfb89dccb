#include "services/common/runtime/plant_sections.hpp"

#include <algorithm>
#include <optional>

#include "services/common/equations/site_table.hpp"
#include "services/common/runtime/asset_sections.hpp"
#include "services/common/text/numbers.hpp"

namespace sealwatch {
namespace {

using equations::TextPlant;

std::vector<std::string> kinds_of_site() {
  std::vector<std::string> names;
  for (int k = 0; k < static_cast<int>(SiteKind::sensor_bias); ++k)
    names.emplace_back(name_of(static_cast<SiteKind>(k)));
  return names;
}

SiteKind kind_named(const std::string& name) {
  const std::vector<std::string> names = kinds_of_site();
  return static_cast<SiteKind>(std::ranges::find(names, name) - names.begin());
}

void read_size(YamlMap& map, std::optional<double>& size) {
  double value = 0.0;
  if (map.read("size", value, kPositive)) size = value;
}

// Of a kind of the catalogue: name to expression; of the plant's own: name to {value, unit}.
void read_signals(YamlMap& map, equations::TextSite& site) {
  auto signals = map.map("signals");
  if (!signals) return;
  const equations::SiteNames& known = equations::names_of_site(site.kind);
  if (site.kind == SiteKind::own) {
    for (const std::string& name : signals->keys()) {
      auto signal = signals->map(name);
      if (!signal) continue;
      site.signals.push_back({.name = name, .value = {}, .unit = {}});
      need(*signal, "value", site.signals.back().value);
      need(*signal, "unit", site.signals.back().unit);
      read_size(*signal, site.signals.back().size);
      signal->finish();
    }
    if (site.signals.size() > kSiteSignals) map.fault("signals", {}, "are more than " + std::to_string(kSiteSignals));
  } else {
    for (const equations::SignalName& signal : known.signals) {
      std::string value;
      if (!signal.name.empty() && signals->read(std::string(signal.name), value))
        site.signals.push_back({std::string(signal.name), value, std::string(signal.unit)});
    }
  }
  signals->finish();
}

// Files from before the key name a motor's element driver, and a pump's pump.
Feeds read_feeds(YamlMap& map, const std::string& element) {
  std::string feeds = element == "driver" ? "motor" : element == "pump" ? "pump" : "anything";
  const auto& names = EnumNames<Feeds>::kNames;
  map.read("feeds", feeds, {names.begin(), names.end()});
  return static_cast<Feeds>(std::ranges::find(names, feeds) - names.begin());
}

equations::TextSite read_site(YamlMap& map, const std::string& element, const std::string& key) {
  equations::TextSite site;
  site.element = element;
  site.key = key;
  std::string kind;
  if (!map.has("kind")) map.fault("kind", {}, "must be given");
  if (!map.read("kind", kind, kinds_of_site())) return site;  // what the rest means depends on it
  site.kind = kind_named(kind);
  map.read("symbol", site.symbol);
  site.feeds = read_feeds(map, element);
  site.unit = equations::names_of_site(site.kind).unit;
  if (site.kind == SiteKind::own) {
    need(map, "unit", site.unit);
    read_size(map, site.size);
  }
  if (auto adds = map.map("adds_to")) {
    for (const std::string& state : adds->keys()) {
      std::string factor;
      if (adds->read(state, factor)) site.adds_to.emplace_back(state, factor);
    }
    adds->finish();
  }
  read_signals(map, site);
  map.finish();
  return site;
}

}  // namespace

void read_elements(YamlMap& root, TextPlant& plant) {
  for_each(root, "elements", [&](const std::string& name, YamlMap& map) {
    ElementDescription element{name, name};
    map.read("meaning", element.meaning);
    std::size_t index = 0;
    for (const YAML::Node& node : map.list("sites")) {
      const std::string key = "elements." + name + ".sites[" + std::to_string(index) + "]";
      YamlMap site = map.inside(node, "sites", index++);
      plant.sites.push_back(read_site(site, name, key));
    }
    plant.elements.push_back(std::move(element));
  });
}

namespace {

void read_law_parameters(YamlMap& map, equations::TextLaw& law) {
  for_each(map, "parameters", [&](const std::string& name, YamlMap& row) {
    equations::TextLawParameter parameter{.name = name, .unit = {}, .meaning = name, .start = {}};
    need(row, "unit", parameter.unit);
    row.read("meaning", parameter.meaning);
    row.read("strength", parameter.strength);
    double usual = 0.0;
    if (row.read("usual", usual)) parameter.start = {usual};
    if (!row.has("usual")) row.fault("usual", {}, "must be given");
    for (const double value : numbers(row, "grid")) parameter.start.push_back(value);
    for (auto [key, target] : {std::pair{"min", &parameter.min}, {"max", &parameter.max}})
      if (!row.read(key, *target) && !row.has(key)) row.fault(key, {}, "must be given");
    if (parameter.strength && !row.read("matters", parameter.significant, kPositive) && !row.has("matters"))
      row.fault("matters", {}, "must be given: the size of a strength from which an engineer would care");
    if (!(parameter.min <= usual && usual <= parameter.max))
      row.fault("usual", text::general(usual), "must lie between min and max");
    law.parameters.push_back(std::move(parameter));
  });
}

}  // namespace

void read_laws(YamlMap& root, TextPlant& plant) {
  std::size_t index = 0;
  for (const YAML::Node& node : root.list("laws")) {
    equations::TextLaw law;
    law.key = "laws[" + std::to_string(index) + "]";
    YamlMap map = root.inside(node, "laws", index++);
    for (auto [key, target] :
         {std::pair{"id", &law.id}, {"element", &law.element}, {"equation", &law.equation}, {"meaning", &law.meaning}})
      need(map, key, *target);
    law.energy = "as the plant's file says";
    map.read("energy", law.energy);
    std::string kind;
    if (map.read("kind", kind, kinds_of_site())) law.kind = kind_named(kind);
    read_law_parameters(map, law);
    if (auto hidden = map.map("hidden")) {
      need(*hidden, "name", law.hidden);
      need(*hidden, "unit", law.hidden_unit);
      need(*hidden, "der", law.hidden_rate);
      hidden->read("size", law.hidden_size, kPositive);
      hidden->read("own", law.hidden_own);
      hidden->read("settles", law.hidden_settles);
      hidden->finish();
    }
    map.finish();
    plant.laws.push_back(std::move(law));
  }
}

std::vector<double> numbers(YamlMap& map, const std::string& key) {
  std::vector<double> values;
  for (const YAML::Node& node : map.list(key)) {
    const auto value = node.IsScalar() ? number_of(node.Scalar()) : std::nullopt;
    if (value)
      values.push_back(*value);
    else
      map.fault(key, node.IsScalar() ? node.Scalar() : "", "must be a list of numbers");
  }
  return values;
}

}  // namespace sealwatch

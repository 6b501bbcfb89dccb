// Parts of a plant's file: elements with their sites, laws of its own; and the small readers that all parts share.
#pragma once

#include <string>
#include <vector>

#include "services/common/equations/text_plant.hpp"
#include "services/common/runtime/yaml_map.hpp"

namespace sealwatch {

/// Reads a text that has to be there.
inline void need(YamlMap& map, const std::string& key, std::string& target) {
  if (!map.read(key, target) && !map.has(key)) map.fault(key, {}, "must be given");
}

/// Reads each entry of a mapping of mappings.
template <class Read>
void for_each(YamlMap& root, const std::string& key, Read read) {
  auto entries = root.map(key);
  if (!entries) return;
  for (const std::string& name : entries->keys())
    if (auto entry = entries->map(name)) {
      read(name, *entry);
      entry->finish();
    } else {
      entries->fault(name, {}, "must be a mapping of keys to values");
    }
  entries->finish();
}

[[nodiscard]] std::vector<double> numbers(YamlMap& map, const std::string& key);

void read_elements(YamlMap& root, equations::TextPlant& plant);
void read_laws(YamlMap& root, equations::TextPlant& plant);

}  // namespace sealwatch

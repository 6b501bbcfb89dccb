#include "services/common/runtime/channel_map_file.hpp"

#include "services/common/runtime/asset_sections.hpp"
#include "services/common/text/numbers.hpp"

namespace sealwatch {
namespace {

constexpr NumberRule kRow{.min = 1.0, .max = 1e6, .words = "must be a row number, 1 for the first"};

struct WordKey {
  const char* name;
  std::string LogLayout::*target;
  std::vector<std::string> known;
};
const std::vector<WordKey>& word_keys() {
  static const std::vector<WordKey> keys = {
      {"delimiter", &LogLayout::delimiter, {"comma", "semicolon", "tab", "bar", "blank"}},
      {"decimal", &LogLayout::decimal, {"point", "comma"}},
      {"time_resets", &LogLayout::time_resets, {"refuse", "join", "split"}},
      {"incomplete_rows", &LogLayout::incomplete_rows, {"refuse", "skip"}},
      {"repeated_times", &LogLayout::repeated_times, {"refuse", "jump"}}};
  return keys;
}
struct RowKey {
  const char* name;
  int LogLayout::*target;
};
constexpr RowKey kRowKeys[] = {
    {"header_row", &LogLayout::header_row}, {"units_row", &LogLayout::units_row}, {"first_row", &LogLayout::first_row}};

void read_layout(YamlMap& map, LogLayout& layout) {
  auto log = map.map("log");
  if (!log) return;
  for (const WordKey& key : word_keys()) log->read(key.name, layout.*key.target, key.known);
  for (const RowKey& key : kRowKeys) log->read(key.name, layout.*key.target, kRow);
  log->finish();
  if (layout.first_row != 0 && layout.first_row <= std::max(layout.header_row, layout.units_row))
    log->fault("first_row", std::to_string(layout.first_row), "must come after header_row and units_row");
}

void read_column(YamlMap& channels, const std::string& channel, ColumnMapping& mapping) {
  const auto node = channels.take(channel);
  if (node && node->IsScalar()) {
    channels.read(channel, mapping.column);
  } else if (node) {
    YamlMap map = channels.inside(*node, channel);
    map.read("column", mapping.column);
    map.read("unit", mapping.unit);
    mapping.is_scaled = map.has("scale") || map.has("offset");
    map.read("scale", mapping.scale);
    map.read("offset", mapping.offset);
    map.finish();
    if (mapping.scale == 0.0) map.fault("scale", "0", "must not be 0: every number would be the same");
  }
  if (mapping.column.empty()) channels.fault(channel, {}, "needs a column", "write {column: ..., unit: ...}");
}

/// One column may be two channels (a switched valve's command, say), one channel never two columns: keys are unique.
void read_columns(YamlMap& map, const PlantDescription* plant, ChannelMap& target) {
  auto channels = map.map("channels");
  if (!channels) return;
  std::vector<std::string> known{"time"};
  if (plant != nullptr)
    for (const std::string& name : names_of_rows(plant->channels)) known.push_back(name);
  else
    known = channels->keys();
  for (const std::string& channel : known)
    if (channels->has(channel)) read_column(*channels, channel, target.columns[channel]);
  if (plant != nullptr)
    for (const std::string& channel : known) (void)channels->take(channel);  // known, named or not
  channels->finish();
}

void write_columns(YAML::Emitter& out, const ChannelMap& map) {
  if (map.columns.empty()) return;
  out << YAML::Key << "channels" << YAML::Value << YAML::BeginMap;
  for (const auto& [channel, mapping] : map.columns) {
    out << YAML::Key << channel << YAML::Value << YAML::Flow << YAML::BeginMap;
    out << YAML::Key << "column" << YAML::Value << YAML::DoubleQuoted << mapping.column;
    if (!mapping.unit.empty()) out << YAML::Key << "unit" << YAML::Value << YAML::DoubleQuoted << mapping.unit;
    if (mapping.is_scaled || mapping.scale != 1.0)
      out << YAML::Key << "scale" << YAML::Value << text::exact(mapping.scale);
    if (mapping.offset != 0.0) out << YAML::Key << "offset" << YAML::Value << text::exact(mapping.offset);
    out << YAML::EndMap;
  }
  out << YAML::EndMap;
}

void write_layout(YAML::Emitter& out, const LogLayout& layout) {
  const LogLayout usual;
  if (layout == usual) return;
  out << YAML::Key << "log" << YAML::Value << YAML::BeginMap;
  for (const WordKey& key : word_keys())
    if (layout.*key.target != usual.*key.target) out << YAML::Key << key.name << YAML::Value << layout.*key.target;
  for (const RowKey& key : kRowKeys)
    if (layout.*key.target != 0) out << YAML::Key << key.name << YAML::Value << layout.*key.target;
  out << YAML::EndMap;
}

}  // namespace

void read_channel_map(YamlMap& map, const PlantDescription* plant, ChannelMap& target) {
  read_columns(map, plant, target);
  read_layout(map, target.log);
}

Checked<ChannelMap> check_channel_map(const std::string& file, const PlantDescription* plant) {
  std::vector<Error> errors;
  const auto root = load_yaml(file, errors);
  if (!root) return tl::unexpected(errors);
  YamlMap map(file, *root, {}, errors);
  ChannelMap target;
  read_channel_map(map, plant, target);
  if (!map.has("asset_id"))
    map.finish();  // of an asset file, the rest says nothing of the log
  else if (!map.has("channels") && !map.has("log"))
    errors.push_back({file, "", "", "has no map: neither channels nor log", "give the asset file that has it"});
  if (!errors.empty()) return tl::unexpected(errors);
  return target;
}

std::string channel_map_to_yaml(const ChannelMap& map) {
  if (map.empty()) return {};
  YAML::Emitter out;
  out << YAML::BeginMap;
  write_columns(out, map);
  write_layout(out, map.log);
  out << YAML::EndMap;
  return std::string(out.c_str()) + "\n";
}

}  // namespace sealwatch

#include "services/common/runtime/fmu_section.hpp"

#include <filesystem>

#include "services/common/runtime/plant_sections.hpp"

namespace sealwatch {
namespace {

/// Variables of the FMU to expressions; a number is one too.
void read_expressions(YamlMap& fmu, const std::string& key, std::vector<std::pair<std::string, std::string>>& to) {
  auto rows = fmu.map(key);
  if (!rows) return;
  for (const std::string& name : rows->keys()) {
    std::string expression;
    if (rows->read(name, expression)) to.emplace_back(name, expression);
  }
  rows->finish();
}

}  // namespace

std::optional<fmi::FmuSection> read_fmu_section(YamlMap& root) {
  auto fmu = root.map("fmu");
  if (!fmu) return std::nullopt;
  fmi::FmuSection section;
  need(*fmu, "file", section.file);
  section.file = (std::filesystem::path(root.file()).parent_path() / section.file).string();
  std::string interface;
  if (fmu->read("interface", interface, {"me", "cs"}))
    section.interface = interface == "cs" ? fmi::Choice::co_simulation : fmi::Choice::model_exchange;
  std::vector<std::pair<std::string, std::string>> settings;
  read_expressions(*fmu, "settings", settings);
  section.settings = fmi::Settings(settings.begin(), settings.end());
  read_expressions(*fmu, "inputs", section.inputs);
  read_expressions(*fmu, "parameters", section.parameters);
  for_each(*fmu, "variables", [&](const std::string& name, YamlMap& map) {
    fmi::FmuVariable variable{.name = name, .variable = name, .unit = {}};
    map.read("variable", variable.variable);
    need(map, "unit", variable.unit);
    section.variables.push_back(std::move(variable));
  });
  fmu->finish();
  return section;
}

}  // namespace sealwatch

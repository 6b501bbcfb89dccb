// The `fmu` section of a plant's file (services/common/fmi/fmu_plant.hpp).
#pragma once

#include <optional>
#include <string>

#include "services/common/fmi/fmu_plant.hpp"
#include "services/common/runtime/yaml_map.hpp"

namespace sealwatch {

/// Nothing where the file has no such section. Its FMU is looked for beside the plant's file.
[[nodiscard]] std::optional<fmi::FmuSection> read_fmu_section(YamlMap& root);

}  // namespace sealwatch

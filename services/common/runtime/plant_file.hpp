// Plants that are written as text: YAML files that an asset names as `model: FILE.yaml` (docs/tutorial-plant.md).
#pragma once

#include <string>
#include <vector>

#include "sealwatch/model/plant_description.hpp"
#include "services/common/equations/text_plant.hpp"
#include "services/common/runtime/asset_file.hpp"

namespace sealwatch {

/// Whether the value of an asset's key `model` is a file and not the name of a plant that is built in.
[[nodiscard]] bool is_plant_file(const std::string& model);

/// What a plant file says, and the plant that it makes; every fault with its line.
struct ReadPlant {
  equations::TextPlant text;
  equations::BuiltPlant built;
};
[[nodiscard]] Checked<ReadPlant> read_plant_file(const std::string& file);

/// Reads a plant file and makes the plant known, so that find_plant() finds it by its name. A file that is known already
/// with the same content is not read again.
[[nodiscard]] Checked<const PlantDescription*> load_plant(const std::string& file);

}  // namespace sealwatch

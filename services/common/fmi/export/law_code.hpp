// The laws of an asset's `physics` as code for the tools that models come from: C functions and Modelica functions, with
// the values that were found as defaults.
#pragma once

#include <string>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/model/plant_description.hpp"

namespace sealwatch::fmi {

struct LawCode {
  std::string c, modelica;
};

/// Sensors' laws are named in a comment.
[[nodiscard]] LawCode law_code(const PlantDescription& plant, const AssetConfig& asset);

}  // namespace sealwatch::fmi

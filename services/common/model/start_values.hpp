// Small types and look-ups that the plants' models share.
#pragma once

#include <string_view>
#include <vector>

#include "sealwatch/model/simulation.hpp"
#include "services/common/model/first_value.hpp"

namespace sealwatch {

struct ModelInput {
  std::string_view name;  ///< recorded channel
  bool hold = false;      ///< held between samples whatever the recording says
};

struct ModelOutput {
  std::string_view channel;
  int state = -1;  ///< the state that it equals; -1: Model::output computes it
};

/// The asset's parameters in the order of the plant's table, defaults where the asset has none.
[[nodiscard]] std::vector<double> parameter_values(const PlantDescription& plant, const AssetConfig& asset);
[[nodiscard]] double parameter_value(const PlantDescription& plant, const ModelValues& values, std::string_view name);

}  // namespace sealwatch

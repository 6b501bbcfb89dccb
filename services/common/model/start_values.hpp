// Small types and look-ups that the plants' models share.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "sealwatch/model/simulation.hpp"

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
/// Where a channel starts: the mean of as many of its first three samples as differ by noise alone, so that one that
/// moves starts at its first sample (Lepski, Theory of Probability 35 (1990) 454). Nothing when it is not recorded.
[[nodiscard]] std::optional<double> first_value(const TimeSeries& recorded, std::string_view channel);
[[nodiscard]] std::optional<double> mean_value(const TimeSeries& recorded, std::string_view channel);

}  // namespace sealwatch

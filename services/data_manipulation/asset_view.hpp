// What data manipulation needs to know of one asset, from its configuration and its plant's table.
#pragma once

#include <optional>
#include <string>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/model/plant_description.hpp"
#include "sealwatch/signal/test_record.hpp"

namespace sealwatch {

/// Both pointers may be null: an asset that is not configured, a plant that is not known.
struct AssetView {
  const AssetConfig* asset = nullptr;
  const PlantDescription* plant = nullptr;

  [[nodiscard]] std::optional<double> parameter(ParameterRole role) const;
  /// The plant, or where it is not known that of assets whose file names none.
  [[nodiscard]] const PlantDescription& described() const { return plant ? *plant : plant_or_default({}); }
  [[nodiscard]] signal::Cylinder cylinder() const;
  [[nodiscard]] double time_constant_s(const std::string& channel) const;
  [[nodiscard]] double noise_std(const std::string& channel) const;
  [[nodiscard]] bool is_input(const std::string& channel) const;
};

}  // namespace sealwatch

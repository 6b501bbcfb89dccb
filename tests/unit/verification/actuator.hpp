// The asset that verification is tested with: the reference model's, sensors included.
#pragma once

#include "services/common/runtime/asset_file.hpp"

namespace sealwatch::verification::testing {

inline AssetConfig actuator() {
  return load_asset(std::string(SEALWATCH_SOURCE_DIR) + "/config/assets/xt03-mv2.yaml").value();
}

inline AssetConfig noiseless(AssetConfig asset) {
  for (auto& [channel, sensor] : asset.sensors) sensor.noise_std = 0.0;
  return asset;
}

}  // namespace sealwatch::verification::testing

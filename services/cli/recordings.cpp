#include "services/cli/recordings.hpp"

#include <utility>

#include "services/cli/session.hpp"
#include "services/common/recording/recording_file.hpp"

namespace sealwatch::cli {

std::optional<std::vector<Recording>> read_recordings(const std::vector<std::string>& files, const AssetConfig& asset,
                                                      const PlantDescription& plant) {
  std::vector<Recording> recordings;
  for (const std::string& file : files) {
    Result<Recording> recording = read_recording(file, plant);
    if (!recording) {
      complain(recording.error());
      return std::nullopt;
    }
    if (!recording->asset_id.empty() && recording->asset_id != asset.asset_id) {
      complain(Error{.file = file,
                     .place = "asset_id",
                     .value = recording->asset_id,
                     .rule = "is not the asset " + asset.asset_id,
                     .advice = "give recordings of this one asset"});
      return std::nullopt;
    }
    recording->asset_id =
        asset.asset_id;  // without a sidecar too: cutting and aligning a test takes the asset's settings
    recordings.push_back(std::move(*recording));
  }
  return recordings;
}

}  // namespace sealwatch::cli

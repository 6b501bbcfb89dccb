// The recordings of a replay, one after the other, as the blocks that data acquisition takes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sealwatch/config/configuration.hpp"
#include "sealwatch/core/recording.hpp"
#include "sealwatch/message/data_acquisition.hpp"
#include "services/cli/commands.hpp"
#include "services/common/runtime/admission.hpp"

namespace sealwatch::cli {

class ReplaySource {
 public:
  /// Recordings are read one at a time, when their turn comes. None where not a single file is there.
  [[nodiscard]] static std::optional<ReplaySource> open(const ReplayOptions& options,
                                                        const Configuration& configuration);
  /// Blocks of the next readable recording; none at the end. A bad recording is complained about and passed over.
  [[nodiscard]] std::vector<RawSamples> next();
  [[nodiscard]] std::size_t tests() const { return files_.size(); }
  [[nodiscard]] std::size_t failures() const { return failures_; }

 private:
  void put_in_order();
  [[nodiscard]] Result<Recording> read(const std::string& file) const;
  [[nodiscard]] Result<std::vector<RawSamples>> blocks(const std::string& file);

  const Configuration* configuration_ = nullptr;
  std::vector<std::string> files_;
  std::optional<ChannelMap> map_;  ///< in place of the configured assets' own
  std::string asset_;              ///< of all recordings, where the command line names one
  Admission admission_;            ///< of what the services would refuse, nothing is concluded here either
  std::size_t next_ = 0;
  std::size_t failures_ = 0;
};

}  // namespace sealwatch::cli

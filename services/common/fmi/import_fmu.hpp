// A first plant file for an FMU (fmu_plant.hpp): everything that the FMU says about itself, with comments where its user
// has to say more: which channels are recorded, which parameters may be fitted, where physics may be missing.
#pragma once

#include <functional>
#include <string>

#include "services/common/fmi/fmu_file.hpp"
#include "services/common/fmi/host_process.hpp"

namespace sealwatch::fmi {

struct ImportOptions {
  /// What is tried that takes a while, and what is not known in the end.
  std::function<void(const std::string&)> tell = [](const std::string&) {};
  double start_s = ProcessLimits{}.start_s;  ///< for its first start
  /// The FMU is started with other values too, to learn what moves its states: each start may take so long, or three times
  /// the first one, and
  double trial_s = 5.0;
  double trials_s = 20.0;  ///< all together.
};

/// The text of the file. `path`: of the FMU as the file is to name it. Starts the FMU for its states; an Error where it
/// does not start.
[[nodiscard]] Result<std::string> plant_file_of(const FmuFile& file, const std::string& path,
                                                const ImportOptions& options = {});

}  // namespace sealwatch::fmi

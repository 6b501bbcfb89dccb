// A first plant file for an FMU (fmu_plant.hpp): everything that the FMU says about itself, with comments where its user
// has to say more: which channels are recorded, which parameters may be fitted, where physics may be missing.
#pragma once

#include <string>

#include "services/common/fmi/fmu_file.hpp"

namespace sealwatch::fmi {

/// The text of the file. `path`: of the FMU as the file is to name it. Starts the FMU once, for its states; an Error
/// where it does not start.
[[nodiscard]] Result<std::string> plant_file_of(const FmuFile& file, const std::string& path);

}  // namespace sealwatch::fmi

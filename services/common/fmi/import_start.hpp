// A unit is started for what its description does not say: where its states begin, what moves them, which outputs show
// them, and the values of parameters without a start.
#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include "services/common/fmi/fmu_process.hpp"
#include "services/common/fmi/import_fmu.hpp"
#include "services/common/fmi/import_rows.hpp"

namespace sealwatch::fmi {

struct ImportStart {
  Beginning beginning;
  std::map<std::size_t, std::vector<double>> starts;  ///< of parameters that the description gives none
  std::vector<bool> linked;  ///< of each state, whether a parameter or an input moves its start

  [[nodiscard]] double of_parameter(const ModelDescription& fmu, const Element& element) const;
};

/// Notes in `rows` which output shows which state, and takes out parameters that have no finite value.
[[nodiscard]] Result<ImportStart> start_unit(const FmuFile& file, const ImportOptions& options, ImportRows& rows);

}  // namespace sealwatch::fmi

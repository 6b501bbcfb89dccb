// On which states derivatives and outputs depend, as ModelStructure declares it (FMI 2.0.4 section 2.2.8, FMI 3.0.1
// section 2.4.8): few differences then give a large Jacobian (column_groups.hpp).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "services/common/fmi/fmu_equations.hpp"

namespace sealwatch::fmi {

/// As Setup::dependencies has it, of the states' derivatives and then of these variables; nothing where the description
/// leaves one of them open, and where no two columns would be found together.
[[nodiscard]] std::vector<std::uint32_t> declared_dependencies(const ModelDescription& description,
                                                               std::span<const std::size_t> outputs);

/// Compares what is declared with the unit's values beside its start. Where a value moves with a state that is not
/// declared, columns are found one by one from then on, and the answer names both; "" otherwise.
[[nodiscard]] Result<std::string> check_dependencies(FmuBlock& block);

}  // namespace sealwatch::fmi

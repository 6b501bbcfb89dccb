// What an import takes of a unit: states, inputs, outputs and parameters, with the names that stand for them.
#pragma once

#include <initializer_list>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "services/common/fmi/fmu_file.hpp"

namespace sealwatch::fmi {

/// One row of the file: an element of the FMU and the name that stands for it.
struct ImportRow {
  Element element;
  std::string name;     ///< in expressions
  std::string channel;  ///< of an output
  std::string unit;
  Conversion scale;
  std::string meaning;
  std::optional<std::size_t> state = {};  ///< that an output shows at the start
  bool alias = false;                     ///< and always: both are one variable of the binary
};

struct ImportRows {
  std::vector<ImportRow> inputs, outputs, parameters, states;
};

/// Without names; of Co-Simulation without states.
[[nodiscard]] ImportRows import_rows(const FmuFile& file);

/// The file names variables: of two with one name it would take the first.
[[nodiscard]] Status check_names(const FmuFile& file, const ImportRows& rows);

void name_rows(const ModelDescription& fmu, ImportRows& rows);

/// A name of expressions: letters, digits and _; each once among the names of `taken`, to which it is added.
[[nodiscard]] std::string name_for(const std::string& name, std::initializer_list<std::set<std::string>*> taken);

/// An Error about the file.
[[nodiscard]] Error import_refusal(const FmuFile& file, std::string value, std::string rule, std::string advice);

}  // namespace sealwatch::fmi

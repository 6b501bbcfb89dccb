// Packs an exported model as an FMU: description, C source, and a binary for Linux on x86-64 where a C compiler is found.
#pragma once

#include <string>

#include "services/common/fmi/export/export_model.hpp"

namespace sealwatch::fmi {

struct WrittenFmu {
  bool binary = false;
  std::string without_binary;  ///< why there is none
};

/// A file of that name that is there already is not written over.
[[nodiscard]] Result<WrittenFmu> write_fmu(const std::string& file, const ExportedModel& model);

}  // namespace sealwatch::fmi

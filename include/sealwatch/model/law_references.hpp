// Quantities of the actuator for whose size the catalogue's laws are written: what a size of 1 (`law_sizes`) stands for.
#pragma once

#include <string_view>
#include <vector>

namespace sealwatch {

struct LawReference {
  std::string_view unit;
  double value = 0.0;
  const char* meaning = "";  ///< "load on its rod"
};
/// By the table of plant `eha`, one for each unit that it has one of.
[[nodiscard]] std::vector<LawReference> law_references();

}  // namespace sealwatch

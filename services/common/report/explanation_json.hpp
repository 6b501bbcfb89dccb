// report.json of `explain` (schema sealwatch.mismatch/1). docs/mismatch-report.md lists all keys with their units.
// Numbers that are not finite are written as null. The same explanation gives the same text.
#pragma once

#include <string>

#include "sealwatch/mismatch/explanation.hpp"

namespace sealwatch::report {

[[nodiscard]] std::string explanation_to_json(const mismatch::Explanation& explanation);

}  // namespace sealwatch::report

// Files of one test, one after the other.
#pragma once

#include <string>
#include <vector>

#include "services/common/recording/log_reader.hpp"

namespace sealwatch {

/// The files in "A.csv+B.csv"; `path` itself where it is one.
[[nodiscard]] std::vector<std::string> parts_of(const std::string& path);

/// Puts the first of `next` behind the last of `tests`, and what else there is in `next` behind that. Times go on: by the
/// clock where both tell it; as they are where they are later; else with the usual step after the last sample.
[[nodiscard]] Status append(std::vector<LogTest>& tests, std::vector<LogTest> next);

}  // namespace sealwatch

// report.html of `explain`: one self-contained page for a maintenance engineer. docs/mismatch-report.md says how to
// read it. The same explanation gives the same page; it holds no date and nothing of the machine that made it.
#pragma once

#include <string>

#include "sealwatch/mismatch/explanation.hpp"

namespace sealwatch::report {

[[nodiscard]] std::string explanation_to_html(const mismatch::Explanation& explanation);

}  // namespace sealwatch::report

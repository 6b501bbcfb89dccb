// The page of `sealwatch validate --simulated`: verdict, courses, differences, regimes, alterations.
#pragma once

#include <string>

#include "sealwatch/trace/trace_comparison.hpp"

namespace sealwatch::cli {

[[nodiscard]] std::string trace_page(const trace::TraceComparison& comparison, const std::string& recorded,
                                     const std::string& simulated);

}  // namespace sealwatch::cli

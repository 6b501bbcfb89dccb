// A comparison of a trace with a recording in words and as JSON (schema sealwatch.trace/1).
#pragma once

#include <string>

#include "sealwatch/trace/trace_comparison.hpp"

namespace sealwatch::cli {

/// "A gain of 1.0200 ± 0.0001 of the sensor position": one alteration.
[[nodiscard]] std::string alteration_text(const trace::Alteration& alteration);

/// The answer in a sentence or two.
[[nodiscard]] std::string trace_summary(const trace::TraceComparison& comparison);

/// What a trace cannot say, and what would.
[[nodiscard]] std::string trace_limit();

[[nodiscard]] std::string trace_json(const trace::TraceComparison& comparison, const std::string& recorded,
                                     const std::string& simulated);

}  // namespace sealwatch::cli

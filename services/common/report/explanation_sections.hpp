// The sections of report.html, each as HTML; "" where there is nothing to say. Internal to explanation_html.
#pragma once

#include <string>
#include <vector>

#include "sealwatch/mismatch/explanation.hpp"

namespace sealwatch::report {

/// "piston, Stribeck friction", with the form where the law has several.
[[nodiscard]] std::string law_name(const mismatch::LawAt& what);
/// "external leakage (laminar) of chamber A"
[[nodiscard]] std::string law_of(const mismatch::LawAt& what);

/// "4.010 ± 0.060 kN", and that it ended at a bound or that the recordings do not tell it: "0.48 rpm, at its bound".
[[nodiscard]] std::string found_value(const mismatch::FoundParameter& parameter);

/// "piston", "sensor of level voltage"
[[nodiscard]] std::string element_name(const std::string& element);

/// In a sentence: "the piston", "chamber A", "the sensor of level voltage".
[[nodiscard]] std::string the_element(const std::string& element);

/// Root mean square over channels of the noise-normalised rms.
struct Misfit {
  double before = 0.0, after = 0.0;
  bool known = false;
};
[[nodiscard]] Misfit overall(const mismatch::PooledFit& fit);

/// The first screen: verdict and figures; then what was found beside the drawing of where it sits; then what to do next.
[[nodiscard]] std::string banner(const mismatch::Explanation& explanation);
[[nodiscard]] std::string first_screen(const mismatch::Explanation& explanation);
[[nodiscard]] std::string next_steps(const mismatch::Explanation& explanation);
/// The same in plain text, the first one first; none where an undetermined explanation knows of none.
[[nodiscard]] std::vector<std::string> steps_of(const mismatch::Explanation& explanation);

/// Below it, closed until they are opened. Paper gets the missing term, traces and totals; without a finding the power.
[[nodiscard]] std::string where_section(const mismatch::Explanation& explanation);
[[nodiscard]] std::string effects_section(const mismatch::Explanation& explanation);
[[nodiscard]] std::string asset_values_section(const mismatch::Explanation& explanation);
[[nodiscard]] std::string missing_section(const mismatch::Explanation& explanation);
[[nodiscard]] std::string overlays_section(const mismatch::Explanation& explanation);
[[nodiscard]] std::string comparison_section(const mismatch::Explanation& explanation);
[[nodiscard]] std::string parameters_section(const mismatch::Explanation& explanation);
[[nodiscard]] std::string prognosis_section(const mismatch::Explanation& explanation);
[[nodiscard]] std::string alternatives_section(const mismatch::Explanation& explanation);
[[nodiscard]] std::string candidates_section(const mismatch::Explanation& explanation);
[[nodiscard]] std::string power_section(const mismatch::Explanation& explanation);
[[nodiscard]] std::string notes_section(const mismatch::Explanation& explanation);

}  // namespace sealwatch::report

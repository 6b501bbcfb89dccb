// Words of an explanation: summary, evidence, the next test. For a maintenance engineer, in plain sentences with units.
#pragma once

#include <string>

#include "sealwatch/mismatch/explanation.hpp"

namespace sealwatch::mismatch {

[[nodiscard]] std::string number(double value, int digits = 3);
[[nodiscard]] std::string element_in_words(const std::string& element);
/// One sentence; of several `effects` the misfit is what all of them leave together.
[[nodiscard]] std::string evidence_of(const FoundEffect& effect, std::size_t effects, double misfit_before,
                                      double misfit_after);
[[nodiscard]] std::string next_test_of(const Explanation& explanation);
[[nodiscard]] std::string summary_of(const Explanation& explanation);

}  // namespace sealwatch::mismatch

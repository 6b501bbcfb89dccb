// Words of an explanation: summary, evidence, the next test. For a maintenance engineer, in plain sentences with units.
#pragma once

#include <string>

#include "sealwatch/mismatch/explanation.hpp"

namespace sealwatch::mismatch {

/// As probable as anything is said to be.
inline constexpr double kNeverCertain = 0.999;

[[nodiscard]] std::string number(double value, int digits = 3);
[[nodiscard]] std::string element_in_words(const std::string& element);
/// "coulomb friction" of "coulomb_friction"
[[nodiscard]] std::string in_words(std::string id);
/// "coulomb friction at the piston"
[[nodiscard]] std::string law_in_words(const LawAt& law);
/// "a, b and c", with `last` before the last one
[[nodiscard]] std::string joined(const std::vector<std::string>& words, const char* last);
/// What broke which rule where, without file and advice: for a remark within a sentence.
[[nodiscard]] std::string reason_in_words(const Error& error);
/// "the misfit of flow on recordings that took no part falls from 5 to 1.01 times the noise", where it falls most; ""
/// without any channel.
[[nodiscard]] std::string proof_in_words(const PooledFit& holdout);
/// " Not all is explained: flow still misses by 7 times the noise."; "" where the noise is nearly reached.
[[nodiscard]] std::string left_in_words(const PooledFit& fit);
/// One sentence; of several `effects` the misfit is what all of them leave together.
[[nodiscard]] std::string evidence_of(const FoundEffect& effect, std::size_t effects, double misfit_before,
                                      double misfit_after);
[[nodiscard]] std::string next_test_of(const Explanation& explanation);
[[nodiscard]] std::string summary_of(const Explanation& explanation);

}  // namespace sealwatch::mismatch

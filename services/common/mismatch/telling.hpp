// Words of an explanation: summary, evidence, the next test. For a maintenance engineer, in plain sentences with units.
#pragma once

#include <string>

#include "sealwatch/mismatch/explanation.hpp"
#include "services/common/text/readable.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::mismatch {

using text::in_words;
using text::joined;

/// In a sentence: 64400, 2.6·10¹³.
[[nodiscard]] inline std::string number(double value, int digits = 3) { return text::in_sentence(value, digits); }

/// As probable as anything is said to be.
inline constexpr double kNeverCertain = 0.999;

[[nodiscard]] std::string element_in_words(const std::string& element);
/// "Coulomb friction at the piston"
[[nodiscard]] std::string law_in_words(const LawAt& law);
/// What broke which rule where, without file and advice: for a remark within a sentence.
[[nodiscard]] std::string reason_in_words(const Error& error);
/// `recordings`: each with the reason.
[[nodiscard]] inline std::string not_compared(const std::string& recordings) {
  return "Not compared, as a model cannot be simulated there: " + recordings + ".";
}
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

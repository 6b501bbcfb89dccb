// The ambiguity group: how likely each fault is, given the deviations of one test.
//
//   z         deviations d of the informative quantities
//   s_h       signature of fault h in advisory widths, a its amplitude (>= 0 unless the fault may have either sign)
//   gain_h    = kappa^2 / 2 max_a (|z|^2 - |z - a s_h|^2)           explained squared deviation, in log-likelihood
//   score_h   = gain_h + bonus_h + ln prior_h                      score of "no fault" is 0
//   likelihood_h = exp(score_h) / (1 + sum of exp(score))
//
// kappa = 3: an advisory width is at least a 99.9 % prediction interval, 3.3 standard deviations. The prior is also the
// complexity penalty: leakage, by far the most frequent failure mechanism of these actuators (dissertation,
// figure 2.4), e^-4.5 per test, every other fault e^-6. So the likelihood of a single fault that explains everything is
// about one half at the advisory limit and 99 % at one and a half times it. Two faults at once are hypotheses too, with
// both priors and both amplitudes; their likelihood is divided between the two as they share the explained deviation.
// bonus_h is what the status and the alignment of a sensor's channel say. Likelihoods below 2 % are left out and the
// rest adds up to 1.
//
// A failed test has a cause: no fault, and faults that could not make a test fail (sensors, but the position's), lose
// e^-9, and friction takes leakage's prior and leakage that of the others. What remains is told apart by the deviations
// or, where nothing was measured, by the prior.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "sealwatch/message/health_assessment.hpp"
#include "services/health_assessment/signatures.hpp"

namespace sealwatch {

struct AmbiguityGroup {
  double no_fault_likelihood = 1.0;
  std::vector<ProposedFault> faults;  ///< most likely first, evidence and ISO 14224 codes filled in
};

/// What is known of a sensor besides the deviations.
struct SensorRemark {
  double bonus = 0.0;  ///< log-likelihood
  std::string text;
};

/// `remarks` by element ("sensor:flow"); `failure`: why the test failed, "" when it did not.
[[nodiscard]] AmbiguityGroup find_ambiguity_group(const std::vector<Deviation>& deviations,
                                                  const std::vector<Signature>& signatures,
                                                  const std::map<std::string, SensorRemark>& remarks,
                                                  const std::string& failure = {});

}  // namespace sealwatch

// How near another explanation comes to what is hidden, by the generator alone: no estimator, no catalogue.
//
//   d = min over u of  sum ((y(truth) - y(rival, u)) / sigma)^2     all samples of all outputs of all tests, no noise
//
// Both are driven by the command that the controller gave to the truth. u: the free parameters of the asset (loads:
// each test's own) and the sizes of the rival's physics. d is the noncentrality with which the best test of statistics
// could tell the two apart: at d < 4 it stays within two standard deviations of the difference's own scatter.
//
// A rival without physics is the refitted model as it is: its d is what the hidden effect leaves of itself once the
// free parameters have swallowed what they can.
//
// Levenberg and Marquardt's method, slopes by differences.
#pragma once

#include "services/verification/truth/trials.hpp"

namespace sealwatch::bench {

struct RivalFit {
  double distance = 0.0;  ///< d
  TruthParameters parameters;
  TruthRival rival;
  /// The same over tests that took no part, shared values as they were found, each test's load alone free.
  double elsewhere = 0.0;
};

/// The rival's sizes are start values.
[[nodiscard]] Result<RivalFit> closest_rival(const TrialPlan& truth, std::span<const PlannedTrialTest> tests,
                                             const TruthRival& rival,
                                             std::span<const PlannedTrialTest> other_tests = {});

}  // namespace sealwatch::bench

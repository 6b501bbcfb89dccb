// The hypotheses about one seal that the state-space forecasters weigh (include/sealwatch/forecast/state_space.hpp).
#pragma once

#include <string>
#include <vector>

#include "sealwatch/forecast/degradation_filter.hpp"

namespace sealwatch::forecast {

/// A test by the months since the first test of the history.
struct DatedTest {
  double months = 0.0;
  double condition = 0.0;
  double condition_std = 0.0;
};

enum class Kinship { member, relative, stranger };
enum class SealChange { none, rate, level, replaced };

struct SealHypothesis {
  SealBelief belief;    ///< after the last test
  double weight = 0.0;  ///< posterior probability
  SealChange change = SealChange::none;
  double changed_months = 0.0;  ///< since the first test
  Kinship kin = Kinship::member;
};

struct HypothesisOptions {
  FleetPopulation population;
  double relative_share = 0.0;              ///< prior probability of a relative
  double change_per_month = 0.01;           ///< of faster ageing
  std::optional<double> age_at_first_test;  ///< [months]; none: not known
};

struct SealOpinion {
  std::vector<SealHypothesis> hypotheses;  ///< those that matter, weights sum to 1
  DegradationLaw law;
  double extra_std = 0.0;           ///< scatter of the estimates that their standard errors do not explain
  double irregularity_scale = 1.0;  ///< of the law's irregularity, where the tests contradict it
};

/// `tests` in the order of time, at least one.
[[nodiscard]] SealOpinion weigh_hypotheses(const std::vector<DatedTest>& tests, const HypothesisOptions& options);

/// Carries all on by `months`.
void grow_old(SealOpinion& opinion, double months);

}  // namespace sealwatch::forecast

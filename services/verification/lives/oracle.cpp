#include "services/verification/lives/oracle.hpp"

#include <cmath>

#include "sealwatch/forecast/degradation_filter.hpp"
#include "services/common/forecast/forecast_parts.hpp"

namespace sealwatch::forecast {

Result<PredictiveDistribution> oracle_distribution(const TrueState& state, double threshold,
                                                   const DegradationSetting& setting) {
  if (!(state.month >= 0.0) || !std::isfinite(state.condition) || !std::isfinite(state.gamma) ||
      !(state.steepening_limit >= 0.0))
    return fail("the true state must be finite, at a month not before the installation");
  if (!std::isfinite(threshold)) return fail("the threshold must be a number");
  if (state.condition <= threshold) return fail("the threshold is passed already");
  const double uniform_std = 1.0 / std::sqrt(12.0);  // of a width of one
  const DegradationLaw law{.n_0 = setting.n_0,
                           .steepening_scatter = uniform_std * state.steepening_limit,
                           .irregularity_std = uniform_std * (setting.irregularity.max - setting.irregularity.min)};
  WeightedBelief known;
  known.belief.age_months = state.month;
  known.belief.mean = {state.condition, state.gamma + 0.5 * (setting.irregularity.min + setting.irregularity.max),
                       0.5 * state.steepening_limit};
  return crossing_distribution({&known, 1}, law, threshold, kLongestMonths);
}

}  // namespace sealwatch::forecast

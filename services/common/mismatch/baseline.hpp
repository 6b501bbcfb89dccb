// The model as it is, fitted to all recordings: with the noise of each channel, in the windows that the plant needs,
// weighed by what the input's unrecorded course leaves, beside fixed values within their tolerances.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sealwatch/mismatch/explain.hpp"
#include "services/common/mismatch/fitted_model.hpp"
#include "services/common/mismatch/time_budget.hpp"

namespace sealwatch::mismatch {

struct Baseline {
  std::shared_ptr<const FittedModel> model;
  double window_s = 0.0;           ///< of the windows in which recordings are simulated; 0: whole recordings
  bool input_swings = false;       ///< between its samples, through much of the tests
  std::vector<std::string> notes;  ///< on noise and input
};

/// Whether a measured input drives the circuit alone.
[[nodiscard]] bool by_measurements(const AssetConfig& asset, const Data& fit);

/// Sets what is known of the recordings in `fit` and `holdout`: noise, weights, tolerances. An Error where the model
/// cannot be simulated.
[[nodiscard]] Result<Baseline> fit_baseline(const AssetConfig& asset, Data& fit, Data& holdout,
                                            const ExplainOptions& options, TimeBudget& time);

}  // namespace sealwatch::mismatch

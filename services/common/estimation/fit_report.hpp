// From the optimum of a search to what is reported of it.
#pragma once

#include <span>

#include "sealwatch/estimation/actuator_fit.hpp"
#include "services/common/estimation/pem_search.hpp"

namespace sealwatch {

/// `input_matters`: what the input does between its samples does more than little to the outputs, and so to the standard
/// errors.
[[nodiscard]] JointFit report_fit(const AssetConfig& asset, const PemProblem& problem, const PemOptimum& optimum,
                                  std::span<const TimeSeries> recordings, bool input_matters);

}  // namespace sealwatch

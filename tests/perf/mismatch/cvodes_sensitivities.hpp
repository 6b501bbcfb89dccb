// The same forward sensitivities by SUNDIALS CVODES: what a user of a good library would write by hand.
#pragma once

#include <vector>

#include "sealwatch/core/time_series.hpp"
#include "sealwatch/model/simulation.hpp"

namespace sealwatch::perf {

struct CvodesRun {
  RowMatrix position;  ///< samples x columns: d position / d strength
  long steps = 0;
};

/// Plant `eha` over `recorded` from `values.initial_state`; columns of `injected`.
[[nodiscard]] CvodesRun sensitivities_by_cvodes(const ModelValues& values, const TimeSeries& recorded,
                                                double relative_tolerance, InjectedColumns& injected);

}  // namespace sealwatch::perf

// From the recording of one test to what the forecast is given, by the same libraries as the services.
//
// `estimate_condition`: phases from the signal library as data manipulation has them, the estimate from the cylinder
// circuit's prediction-error minimisation, and whether it counts from prognostic assessment (0.7 ms a test at 50 Hz).
// Left out are the layers' parts that do nothing to a uniform, complete, aligned recording: ids, status, resampling,
// the search for time offsets. `estimate_through_layers` runs data acquisition and data manipulation themselves, as the
// services do (2.4 ms). A test shows that both give the same estimate.
#pragma once

#include <optional>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/core/time.hpp"
#include "sealwatch/core/time_series.hpp"
#include "sealwatch/forecast/condition_history.hpp"

namespace sealwatch::verification {

/// None: the test may not take part in a forecast.
[[nodiscard]] std::optional<forecast::ConditionSample> estimate_condition(const AssetConfig& asset,
                                                                          const TimeSeries& samples, UtcTime when);

[[nodiscard]] std::optional<forecast::ConditionSample> estimate_through_layers(const AssetConfig& asset,
                                                                               const TimeSeries& samples, UtcTime when);

}  // namespace sealwatch::verification

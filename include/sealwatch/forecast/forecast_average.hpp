// Average of forecasters that have proved themselves on this very seal: each member's weight follows from what it said
// about tests that have come since.
//
//   w_m  proportional to  prior_m exp(eta sum_k log p_m(theta_k | history up to t_k - lead_k))
//
//   p_m  member m's density of the estimate theta_k: its forecast of the condition and the estimate's own standard
//        error; k runs over all tests up to a year after each of some earlier dates
//   eta  below 1, because these forecasts overlap and are dependent
//
// The forecast is the linear pool of the members' distributions; a member that has no number takes no part. E. g. J. A.
// Hoeting et al., Bayesian model averaging, 1999; Y. Yao et al., Using stacking to average predictive distributions,
// 2018.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sealwatch/forecast/forecaster.hpp"

namespace sealwatch::forecast {

class AverageForecaster final : public Forecaster {
 public:
  /// Members by their settings, which must not be averages themselves; none: default_members().
  [[nodiscard]] static Result<std::unique_ptr<const Forecaster>> make(const ForecasterSettings& settings);
  /// fleet and state_space over the window of the settings, ols_drift over 24, 36 and 48 months.
  [[nodiscard]] static std::vector<ForecasterSettings> default_members(const ForecasterSettings& settings);

  [[nodiscard]] std::vector<ConditionForecast> predict_conditions(const ForecastRequest& request,
                                                                  std::span<const UtcTime> when) const override;
  /// In the order of the members, sum 1.
  [[nodiscard]] std::vector<double> weights(const ForecastRequest& request) const;

 private:
  [[nodiscard]] PredictiveForecast answer(const ForecastRequest& request) const override;
  AverageForecaster() = default;

  int window_months_ = 0;
  std::vector<ForecasterSettings> settings_;
  std::vector<std::unique_ptr<const Forecaster>> members_;
};

}  // namespace sealwatch::forecast

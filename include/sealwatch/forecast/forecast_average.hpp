// Average of forecasters that have proved themselves on this very seal: each member's weight follows from what it said
// about tests that have come since.
//
//   w_m  proportional to  prior_m exp(eta sum_k log p_m(theta_k | history up to t_k - lead_k))
//
//   p_m  member m's density of the estimate; eta < 1 because the scored forecasts overlap and are dependent
//
// The forecast is the linear pool of the members' distributions; a member that has no number takes no part.
#pragma once

#include "sealwatch/forecast/forecaster.hpp"

namespace sealwatch::forecast {

class AverageForecaster final : public Forecaster {
 public:
  /// Members by their settings, which must not be averages themselves.
  [[nodiscard]] static Result<std::unique_ptr<const Forecaster>> make(const ForecasterSettings& settings);
  [[nodiscard]] PredictiveForecast predict(const ForecastRequest& request) const override;
  [[nodiscard]] std::optional<ConditionForecast> predict_condition(const ForecastRequest& request,
                                                                   UtcTime when) const override;

 private:
  AverageForecaster() = default;
  std::vector<double> weights(const ForecastRequest& request) const;
  int window_months_ = 0;
  std::vector<std::unique_ptr<const Forecaster>> members_;
  std::vector<std::string> names_;
};

}  // namespace sealwatch::forecast

// Forecast by the straight degradation line (degradation_line.hpp) over the last months.
#pragma once

#include <string>

#include "sealwatch/forecast/forecaster.hpp"

namespace sealwatch::forecast {

/// The time that is linear in the condition.
enum class DegradationTime { months, log_months };

struct OlsOptions {
  std::string method = "ols";
  int window_months = 36;
  DegradationTime time = DegradationTime::months;
  /// kappa: standard deviation of the future slope relative to the window's slope [1].
  double slope_drift = 0.0;
  /// Fieller's interval of inverse regression as textbooks give it: for the date at which an *estimate* reads
  /// theta_max, so that all scatter about the line counts, sigma_p^2 = sigma^2; without it only the seal's own
  /// irregularity does.
  bool whole_scatter = false;
  /// One-sided level at which the slope must be negative. At 1 % all quantiles up to 97.5 % exist.
  double significance = 0.01;
  /// Share of the window's months that must have a usable test. Half: the rest is bridged, not guessed.
  double fewest_tests_share = 0.5;
  /// Beyond this an extrapolation of a few years means nothing: 2.5 times the service life of 20 years.
  double horizon_months = 600.0;

  [[nodiscard]] Status validate() const;
};

class OlsForecaster final : public Forecaster {
 public:
  [[nodiscard]] static Result<std::unique_ptr<const Forecaster>> make(const OlsOptions& options);
  [[nodiscard]] std::vector<ConditionForecast> predict_conditions(const ForecastRequest& request,
                                                                  std::span<const UtcTime> when) const override;

 private:
  [[nodiscard]] PredictiveForecast answer(const ForecastRequest& request) const override;
  explicit OlsForecaster(OlsOptions options) : options_(std::move(options)) {}
  OlsOptions options_;
};

}  // namespace sealwatch::forecast

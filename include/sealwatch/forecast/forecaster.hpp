// From a history of seal conditions to the remaining useful life: one interface, any number of forecasters side by
// side.
//
//   t_RUL = t_hat(theta_max) - now        (docs/forecast.md)
//
// States. `past_threshold`: the condition is at or below theta_max. `insufficient_history`: the window is not filled.
// `no_significant_trend`: the condition does not fall significantly, or so slowly that no date can be told. Only `ok`
// carries numbers, and those are finite and not negative. docs/forecast.md gives every rule with its reason.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sealwatch/core/result.hpp"
#include "sealwatch/core/time.hpp"
#include "sealwatch/forecast/condition_history.hpp"
#include "sealwatch/forecast/fleet_population.hpp"
#include "sealwatch/forecast/forecast.hpp"
#include "sealwatch/forecast/predictive_distribution.hpp"

namespace sealwatch::forecast {

/// A date whose failure probability is asked for: the next vessel campaign.
struct FailureHorizon {
  std::string label;
  UtcTime before;
};

/// A threshold outside (0, 1], or not a number, is an Error of whoever is asked.
struct ForecastRequest {
  std::vector<ConditionSample> history = {};  ///< since the last replacement, in the order of time
  double threshold = 0.60;                    ///< theta_max
  UtcTime now = {};                           ///< from where the remaining life counts
  std::optional<UtcTime> installed = {};      ///< when the seal was new; unknown: one month before its first test
  std::vector<FailureHorizon> horizons = {};  ///< those not after `now` are passed over
  [[nodiscard]] Status validate() const;
};

/// The message and, in state ok, the whole distribution that its numbers are quantiles of.
struct PredictiveForecast {
  Forecast forecast;
  std::optional<PredictiveDistribution> distribution = {};
};

/// What the condition will be: location and scale of a Student t distribution (0 degrees of freedom: normal). The
/// condition itself; an estimate of it scatters by its own standard error besides.
struct ConditionForecast {
  UtcTime time;
  double condition = 0.0;
  double condition_std = 0.0;
  int degrees_of_freedom = 0;
  /// Scatter of estimates that their standard errors do not explain, where the forecaster has found any.
  double extra_std = 0.0;
};

/// Pure: the same request gives the same answer.
class Forecaster {
 public:
  virtual ~Forecaster() = default;
  /// An Error for a request that does not validate.
  [[nodiscard]] Result<PredictiveForecast> predict(const ForecastRequest& request) const;
  /// The condition at each time of `when`, none before `request.now`; empty when there are too few tests.
  [[nodiscard]] virtual std::vector<ConditionForecast> predict_conditions(const ForecastRequest& request,
                                                                          std::span<const UtcTime> when) const = 0;
  [[nodiscard]] Result<Forecast> forecast(const ForecastRequest& request) const;

 private:
  [[nodiscard]] virtual PredictiveForecast answer(const ForecastRequest& valid_request) const = 0;
};

/// Which forecaster, by name:
///   state_space   the degradation law as a state-space model           fleet         the same, pooled with the fleet
///   average       average of `members` by their past scores
///   ols           straight line of theta over t                        ols_log_time  the same over ln t
///   ols_drift     as ols, and carries that the slope will change       ols_fieller   as ols, with Fieller's interval
struct ForecasterSettings {
  std::string method = "ols";
  int window_months = 36;           ///< tests older than this are passed over; the laws take kWholeLife_months
  FleetPopulation population = {};  ///< of state_space, fleet and average
  double change_per_month = 0.01;   ///< of the same: prior probability that a seal begins to age faster
  std::vector<ForecasterSettings> members = {};  ///< of average; none: its default members
};
inline constexpr int kWholeLife_months = 240;  ///< 20 years of service

[[nodiscard]] const std::vector<std::string>& forecast_methods();
[[nodiscard]] Result<std::unique_ptr<const Forecaster>> make_forecaster(const ForecasterSettings& settings);

/// The primary one first: state_space, by the comparison in docs/forecast.md; then the lines of the same page, and
/// the others for comparison.
[[nodiscard]] std::vector<ForecasterSettings> default_forecasters();

/// Several forecasters that judge the same history.
class ForecastPanel {
 public:
  [[nodiscard]] static Result<ForecastPanel> make(const std::vector<ForecasterSettings>& settings);

  struct Answer {
    std::vector<Forecast> forecasts;  ///< in the order of the settings
    /// Beside each forecast; none unless it is ok.
    std::vector<std::optional<PredictiveDistribution>> distributions;
    bool windows_disagree = false;  ///< 95 % intervals of two windows of one method do not overlap
    std::string disagreement;
    std::vector<ConditionSample> used;      ///< in the order of time
    std::vector<ConditionSample> left_out;  ///< isolated outliers (condition_history.hpp), and what is no number
  };
  /// Sorts the history by time and leaves out first: isolated outliers, samples that are no number of a condition (not
  /// finite, beyond a thousand, a negative standard error), and all but one of equal samples (a test that was delivered
  /// twice). An Error for a request that does not validate.
  [[nodiscard]] Result<Answer> forecast(ForecastRequest request) const;

 private:
  std::vector<std::unique_ptr<const Forecaster>> forecasters_;
};

}  // namespace sealwatch::forecast

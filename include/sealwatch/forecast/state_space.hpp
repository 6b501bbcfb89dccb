// Forecast by a bank of Kalman filters on the degradation law (degradation_filter.hpp), each a hypothesis about this
// seal:
//
//   member    its constants are those of the population
//   relative  they spread three times as widely
//   stranger  they may be anything of that order
//   age       where the installation is not known: how old it was at its first test
//   rate      from one month on it ages faster, by all of the law (contaminated fluid, another temperature)
//   level     from one month on the estimates stand at another level (another load, a repaired sensor)
//   replaced  from one month on it is another, new seal, and nobody has said so
//
// Their probabilities follow from the evidence of all tests (Bayes), the forecast is their mixture. Nothing random is
// drawn: the same request gives the same answer. Methods: `state_space` holds one seal in four for a relative (the
// physics, and this seal's own tests); `fleet` none (shrinkage to the fleet, useful before 24 tests exist).
#pragma once

#include <string>

#include "sealwatch/forecast/forecaster.hpp"

namespace sealwatch::forecast {

struct StateSpaceOptions {
  std::string method = "state_space";
  int window_months = 240;  ///< older tests are passed over; a filter forgets by itself
  FleetPopulation population = {};
  double relative_share = 0.25;    ///< prior probability that it is only related to the population
  int fewest_tests = 6;            ///< below: insufficient_history
  double change_per_month = 0.01;  ///< prior probability that it begins to age faster in a month
  double horizon_months = 600.0;   ///< a median beyond this is no date

  [[nodiscard]] Status validate() const;
};

class StateSpaceForecaster final : public Forecaster {
 public:
  [[nodiscard]] static Result<std::unique_ptr<const Forecaster>> make(const StateSpaceOptions& options);
  [[nodiscard]] std::vector<ConditionForecast> predict_conditions(const ForecastRequest& request,
                                                                  std::span<const UtcTime> when) const override;

 private:
  [[nodiscard]] PredictiveForecast answer(const ForecastRequest& request) const override;
  explicit StateSpaceForecaster(StateSpaceOptions options) : options_(std::move(options)) {}
  StateSpaceOptions options_;
};

}  // namespace sealwatch::forecast

// What `sealwatch forecast` is asked: the history, its seal's threshold, the dates and what failing costs.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sealwatch/config/configuration.hpp"
#include "sealwatch/config/site_decision.hpp"
#include "sealwatch/forecast/decision.hpp"
#include "sealwatch/forecast/forecaster.hpp"
#include "sealwatch/message/advisory_generation.hpp"
#include "services/cli/commands.hpp"

namespace sealwatch::cli {

/// A test that the services left out of their forecasts, and why.
struct TestNotCounted {
  UtcTime time;
  std::string why;
};

struct ForecastQuestion {
  forecast::ForecastRequest request;
  std::string asset_id;                    ///< "" without an asset file
  std::string part = "piston seal";        ///< what wears
  std::string worn_parameter = "leakage";  ///< by which it does
  std::size_t tests = 0;  ///< of the whole history; none: replaced at request.installed and not tested since
  UtcTime first = {}, last = {};
  std::vector<forecast::ConditionSample> vague = {};  ///< left out as the services would leave them out
  std::vector<TestNotCounted> not_counted = {};       ///< of a history that the services judged
  std::size_t without_error = 0;                      ///< tests whose standard error is not known
  std::vector<forecast::ForecasterSettings> forecasters = {};
  std::optional<SiteCosts> costs = {};
  double months_to_vessel = 12.0;       ///< from call to arrival
  std::optional<Advisory> advice = {};  ///< in force after the last test, of a history that the services judged
};

/// Campaigns, costs and lead time of a site; the site may be unknown.
void take_site(const Configuration& configuration, const std::string& site, ForecastQuestion& question);

/// Of a history in a file, or of what the services keep. None when something is wrong; it is on standard error then.
[[nodiscard]] std::optional<ForecastQuestion> forecast_question(const ForecastOptions& options);

/// How many tests from when to when, or that there is none since the replacement.
[[nodiscard]] std::string history_words(const ForecastQuestion& question);

/// What all forecasters say; without a test, that there is none since the replacement.
[[nodiscard]] Result<forecast::ForecastPanel::Answer> answer_of(const ForecastQuestion& question);

/// Whether the answer gives the probability of failure before a date.
[[nodiscard]] bool tells_probability(const Forecast& forecast);

/// Going now, at each date that was asked for, and waiting, by the primary forecaster. Empty without its forecast.
[[nodiscard]] std::vector<DecisionOption> decision_of(const ForecastQuestion& question,
                                                      const forecast::ForecastPanel::Answer& answer);

/// Expected costs as forecast/decision.hpp takes them.
[[nodiscard]] forecast::InterventionCosts intervention_costs(const ForecastQuestion& question);

}  // namespace sealwatch::cli

// `sealwatch forecast`: remaining useful life from a history of estimates.
#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "services/cli/commands.hpp"
#include "services/cli/forecast_page.hpp"
#include "services/cli/forecast_question.hpp"
#include "services/cli/forecast_text.hpp"
#include "services/cli/session.hpp"
#include "services/cli/terminal.hpp"

namespace sealwatch::cli {
namespace {

using Json = nlohmann::ordered_json;
using forecast::ConditionSample;

Json forecast_json(const Forecast& forecast) {
  Json json = {{"method", forecast.method},
               {"window_months", forecast.window_months},
               {"state", std::string(name_of(forecast.state))},
               {"explanation", forecast.explanation},
               {"tests_used", forecast.tests_used}};
  if (!tells_probability(forecast)) return json;
  if (forecast.state == ForecastState::ok) {
    json["rul_months"] = {
        {"p10", forecast.rul_p10_months}, {"p50", forecast.rul_p50_months}, {"p90", forecast.rul_p90_months}};
    json["interval_95"] = {forecast.interval_95_low_months, forecast.interval_95_high_months};
    json["end_of_life"] = date(forecast.end_of_life_ns);
  }
  json["failure_probability_before"] = Json::object();
  for (const FailureProbability& item : forecast.failure_probability)
    json["failure_probability_before"][date(item.before_ns)] = item.probability;
  return json;
}

Json decision_json(const std::vector<DecisionOption>& decision) {
  Json json = Json::array();
  for (const DecisionOption& option : decision) {
    Json row = {{"replacement", option.label},
                {"at", date(option.at_ns)},
                {"months", option.months},
                {"failure_probability_before", option.failure_probability}};
    if (option.cost_known) {
      row["expected_cost"] = option.expected_cost;
      row["currency"] = option.currency;
      row["cheapest"] = option.cheapest;
    }
    json.push_back(std::move(row));
  }
  return json;
}

void print_json(const ForecastQuestion& question, const forecast::ForecastPanel::Answer& answer,
                const std::vector<DecisionOption>& decision) {
  Json json = {{"schema", "sealwatch.forecast/1"},
               {"asset_id", question.asset_id},
               {"at", format_utc(question.last)},
               {"threshold", question.request.threshold},
               {"tests", question.tests},
               {"tests_without_standard_error", question.without_error},
               {"windows_disagree", answer.windows_disagree},
               {"forecasts", Json::array()},
               {"decision", decision_json(decision)},
               {"left_out", Json::array()}};
  for (const Forecast& forecast : answer.forecasts) json["forecasts"].push_back(forecast_json(forecast));
  for (const auto* samples : {&answer.left_out, &question.vague})
    for (const ConditionSample& sample : *samples) json["left_out"].push_back(format_utc(sample.time));
  for (const TestNotCounted& test : question.not_counted) json["left_out"].push_back(format_utc(test.time));
  std::printf("%s\n", json.dump(1).c_str());
}

void print_text(const ForecastQuestion& question, const forecast::ForecastPanel::Answer& answer,
                const std::vector<DecisionOption>& decision) {
  if (question.tests == 0) {
    std::printf("%s: %s; a forecast needs tests of the %s that is in there now\n", question.asset_id.c_str(),
                history_words(question).c_str(), question.part.c_str());
    return;
  }
  std::printf("%s; the %s fails at %s\n%s%s", history_words(question).c_str(), question.part.c_str(),
              percent(question.request.threshold, 0).c_str(), forecast_table(answer.forecasts).c_str(),
              decision_chart(decision).c_str());
  if (!question.request.horizons.empty() && !tells_probability(answer.forecasts.front()))
    std::printf("  P(failure)       unknown without a forecast\n");
  if (question.without_error > 0)
    std::printf("standard errors: unknown for %zu of %zu tests; the scatter of the tests replaces them\n",
                question.without_error, question.request.history.size());
  for (const ConditionSample& sample : question.vague)
    std::printf("left out as too vague: %s, theta %s ± %s\n", format_date(sample.time).c_str(),
                number(sample.condition, 3).c_str(), number(sample.condition_std, 2).c_str());
  for (const ConditionSample& sample : answer.left_out)
    std::printf("left out as an isolated outlier: %s, theta %s\n", format_date(sample.time).c_str(),
                number(sample.condition, 3).c_str());
  for (const TestNotCounted& test : question.not_counted)
    std::printf("left out by the services: %s, %s\n", format_date(test.time).c_str(), test.why.c_str());
  if (answer.windows_disagree) std::printf("windows disagree: %s\n", answer.disagreement.c_str());
}

}  // namespace

int run_forecast(const ForecastOptions& options) {
  const auto question = forecast_question(options);
  if (!question) return kBadInput;
  const auto answered = answer_of(*question);
  if (!answered) {
    complain(answered.error());
    return kBadInput;
  }
  const forecast::ForecastPanel::Answer& answer = *answered;
  const std::vector<DecisionOption> decision = decision_of(*question, answer);
  if (!options.page.empty())
    if (const Status written = write_forecast_page(options.page, forecast_body(*question, answer, decision));
        !written) {
      complain(written.error());
      return kBadInput;
    }
  options.json ? print_json(*question, answer, decision) : print_text(*question, answer, decision);
  if (!options.page.empty() && !options.json)
    std::printf("wrote %s: the forecast as a page for a browser\n", options.page.c_str());
  const bool any = std::any_of(answer.forecasts.begin(), answer.forecasts.end(),
                               [](const Forecast& forecast) { return forecast.state == ForecastState::ok; });
  return any ? kOk : kAnswerIsNo;
}

}  // namespace sealwatch::cli

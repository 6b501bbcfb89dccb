// `sealwatch forecast`: remaining useful life from a history of estimates (INTERFACES section 6).
#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "sealwatch/forecast/forecaster.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/forecast_text.hpp"
#include "services/cli/session.hpp"
#include "services/cli/terminal.hpp"
#include "services/common/forecast/history.hpp"
#include "services/common/runtime/asset_file.hpp"
#include "services/prognostic_assessment/prognostic_assessment.hpp"

namespace sealwatch::cli {
namespace {

using Json = nlohmann::ordered_json;
using forecast::ConditionSample;

/// What is asked, and which rows of the history do not count for it.
struct Question {
  forecast::ForecastRequest request;
  std::size_t tests = 0;  ///< of the whole history
  UtcTime first = {}, last = {};
  std::vector<ConditionSample> vague = {};  ///< left out as the services would leave them out
  std::size_t without_error = 0;            ///< tests whose standard error is not known
};

/// Whether the answer gives the probability of failure before a date.
bool tells_probability(const Forecast& forecast) {
  return forecast.state == ForecastState::ok || forecast.state == ForecastState::past_threshold;
}

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

/// Takes out the tests that are too vague for the services' forecasts, so that both tell the same.
std::vector<ConditionSample> take_vague(std::vector<ConditionSample>& history) {
  const double largest = prognostic_assessment::Options{}.largest_condition_std;
  const auto vague = std::stable_partition(
      history.begin(), history.end(), [&](const ConditionSample& sample) { return sample.condition_std <= largest; });
  std::vector<ConditionSample> taken(vague, history.end());
  history.erase(vague, history.end());
  return taken;
}

bool take_horizons(const ForecastOptions& options, forecast::ForecastRequest& request) {
  for (const std::string& text : options.before) {
    Result<UtcTime> before = parse_utc(text);
    if (!before) {
      before.error().place = "--before";
      complain(before.error());
      return false;
    }
    if (*before <= request.now)
      std::fprintf(stderr, "sealwatch: --before %s: passed over, as it is not after the last test (%s)\n", text.c_str(),
                   format_date(request.now).c_str());
    request.horizons.push_back({.label = text, .before = *before});
  }
  return true;
}

std::optional<Question> question_of(const ForecastOptions& options, const std::optional<AssetConfig>& asset) {
  const std::optional<SealSetting> seal = asset ? asset->seal : std::nullopt;
  auto history = forecast::read_history(options.history_file, seal);
  if (!history) {
    complain(history.error());
    return std::nullopt;
  }
  Question question{.request = {.history = std::move(*history),
                                .threshold = options.threshold_given || !seal ? options.threshold : seal->threshold}};
  forecast::ForecastRequest& request = question.request;
  if (!(request.threshold > 0.0 && request.threshold <= 1.0)) {
    complain(Error{.file = {},
                   .place = "--threshold",
                   .value = number(request.threshold),
                   .rule = "must be above 0, at most 1",
                   .advice = "0.6 for a seal that has failed at 60 % of its elastic modulus"});
    return std::nullopt;
  }
  question.tests = request.history.size();
  question.first = request.history.front().time;
  question.last = request.now = request.history.back().time;
  question.vague = take_vague(request.history);
  question.without_error = static_cast<std::size_t>(
      std::count_if(request.history.begin(), request.history.end(),
                    [](const ConditionSample& sample) { return sample.condition_std == 0.0; }));
  if (!take_horizons(options, request)) return std::nullopt;
  return question;
}

void print_json(const Question& question, const forecast::ForecastPanel::Answer& answer) {
  Json json = {{"schema", "sealwatch.forecast/1"},
               {"at", format_utc(question.last)},
               {"threshold", question.request.threshold},
               {"tests", question.tests},
               {"tests_without_standard_error", question.without_error},
               {"windows_disagree", answer.windows_disagree},
               {"forecasts", Json::array()},
               {"left_out", Json::array()}};
  for (const Forecast& forecast : answer.forecasts) json["forecasts"].push_back(forecast_json(forecast));
  for (const auto* samples : {&answer.left_out, &question.vague})
    for (const ConditionSample& sample : *samples) json["left_out"].push_back(format_utc(sample.time));
  std::printf("%s\n", json.dump(1).c_str());
}

void print_text(const Question& question, const forecast::ForecastPanel::Answer& answer) {
  std::printf("%zu %s, %s to %s; the seal fails at %s\n%s", question.tests, question.tests == 1 ? "test" : "tests",
              format_date(question.first).c_str(), format_date(question.last).c_str(),
              percent(question.request.threshold, 0).c_str(), forecast_table(answer.forecasts).c_str());
  if (!question.request.horizons.empty() && !tells_probability(answer.forecasts.front()))
    std::printf("  P(failure)       cannot be told before any date without a forecast\n");
  if (question.without_error > 0)
    std::printf("standard errors: not known of %zu of %zu tests; how the tests scatter stands for them\n",
                question.without_error, question.request.history.size());
  for (const ConditionSample& sample : question.vague)
    std::printf("left out as too vague: %s, theta %s +- %s\n", format_date(sample.time).c_str(),
                number(sample.condition, 3).c_str(), number(sample.condition_std, 2).c_str());
  for (const ConditionSample& sample : answer.left_out)
    std::printf("left out as an isolated outlier: %s, theta %s\n", format_date(sample.time).c_str(),
                number(sample.condition, 3).c_str());
  if (answer.windows_disagree) std::printf("windows disagree: %s\n", answer.disagreement.c_str());
}

}  // namespace

int run_forecast(const ForecastOptions& options) {
  std::optional<AssetConfig> asset;
  if (!options.asset_file.empty() && !(asset = load_asset_or_explain(options.asset_file))) return kBadInput;
  const auto question = question_of(options, asset);
  if (!question) return kBadInput;
  const auto panel = forecast::ForecastPanel::make(forecast::default_forecasters());
  if (!panel) {
    complain(panel.error());
    return kInternalFailure;
  }
  const auto answer = panel->forecast(question->request);
  options.json ? print_json(*question, answer) : print_text(*question, answer);
  const bool any = std::any_of(answer.forecasts.begin(), answer.forecasts.end(),
                               [](const Forecast& forecast) { return forecast.state == ForecastState::ok; });
  return any ? kOk : kAnswerIsNo;
}

}  // namespace sealwatch::cli

// `sealwatch forecast`: remaining useful life from a history of estimates (INTERFACES section 6).
#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "sealwatch/forecast/forecaster.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/session.hpp"
#include "services/cli/summary.hpp"
#include "services/cli/terminal.hpp"
#include "services/common/forecast/history.hpp"
#include "services/common/runtime/asset_file.hpp"

namespace sealwatch::cli {
namespace {

using Json = nlohmann::ordered_json;

Json forecast_json(const Forecast& forecast) {
  Json json = {{"method", forecast.method},
               {"window_months", forecast.window_months},
               {"state", std::string(name_of(forecast.state))},
               {"explanation", forecast.explanation},
               {"tests_used", forecast.tests_used}};
  if (forecast.state != ForecastState::ok) return json;
  json["rul_months"] = {
      {"p10", forecast.rul_p10_months}, {"p50", forecast.rul_p50_months}, {"p90", forecast.rul_p90_months}};
  json["interval_95"] = {forecast.interval_95_low_months, forecast.interval_95_high_months};
  json["end_of_life"] = date(forecast.end_of_life_ns);
  json["failure_probability_before"] = Json::object();
  for (const FailureProbability& item : forecast.failure_probability)
    json["failure_probability_before"][date(item.before_ns)] = item.probability;
  return json;
}

std::optional<forecast::ForecastRequest> request_of(const ForecastOptions& options,
                                                    const std::optional<AssetConfig>& asset) {
  forecast::ForecastRequest request;
  const std::optional<SealSetting> seal = asset ? asset->seal : std::nullopt;
  auto history = forecast::read_history(options.history_file, seal);
  if (!history) {
    complain(history.error());
    return std::nullopt;
  }
  request.history = std::move(*history);
  request.threshold = options.threshold_given || !seal ? options.threshold : seal->threshold;
  if (!request.history.empty()) request.now = request.history.back().time;
  for (const std::string& text : options.before) {
    Result<UtcTime> before = parse_utc(text);
    if (!before) {
      before.error().place = "--before";
      complain(before.error());
      return std::nullopt;
    }
    if (!request.history.empty() && *before <= request.now)
      std::fprintf(stderr, "sealwatch: --before %s: passed over, as it is not after the last test (%s)\n", text.c_str(),
                   format_date(request.now).c_str());
    request.horizons.push_back({.label = text, .before = *before});
  }
  return request;
}

}  // namespace

int run_forecast(const ForecastOptions& options) {
  std::optional<AssetConfig> asset;
  if (!options.asset_file.empty() && !(asset = load_asset_or_explain(options.asset_file))) return kBadInput;
  const auto request = request_of(options, asset);
  if (!request) return kBadInput;
  const auto panel = forecast::ForecastPanel::make(forecast::default_forecasters());
  if (!panel) {
    complain(panel.error());
    return kInternalFailure;
  }
  const auto answer = panel->forecast(*request);
  const bool any = std::any_of(answer.forecasts.begin(), answer.forecasts.end(),
                               [](const Forecast& forecast) { return forecast.state == ForecastState::ok; });
  if (options.json) {
    Json json = {{"schema", "sealwatch.forecast/1"},
                 {"at", format_utc(request->now)},
                 {"threshold", request->threshold},
                 {"tests", request->history.size()},
                 {"windows_disagree", answer.windows_disagree},
                 {"forecasts", Json::array()},
                 {"left_out", Json::array()}};
    for (const Forecast& forecast : answer.forecasts) json["forecasts"].push_back(forecast_json(forecast));
    for (const auto& sample : answer.left_out) json["left_out"].push_back(format_utc(sample.time));
    std::printf("%s\n", json.dump(1).c_str());
  } else {
    std::printf("%zu tests, %s to %s; the seal fails at %s\n%s", request->history.size(),
                request->history.empty() ? "-" : format_date(request->history.front().time).c_str(),
                request->history.empty() ? "-" : format_date(request->now).c_str(),
                percent(request->threshold, 0).c_str(), forecast_table(answer.forecasts).c_str());
    for (const auto& sample : answer.left_out)
      std::printf("left out as an isolated outlier: %s, theta %s\n", format_date(sample.time).c_str(),
                  number(sample.condition, 3).c_str());
    if (answer.windows_disagree) std::printf("windows disagree: %s\n", answer.disagreement.c_str());
  }
  return any ? kOk : kAnswerIsNo;
}

}  // namespace sealwatch::cli

#include "services/cli/forecast_question.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "sealwatch/core/text.hpp"
#include "sealwatch/forecast/configured.hpp"
#include "services/cli/concluded_history.hpp"
#include "services/cli/session.hpp"
#include "services/cli/terminal.hpp"
#include "services/common/forecast/history.hpp"
#include "services/prognostic_assessment/prognostic_assessment.hpp"

namespace sealwatch::cli {
namespace {

using forecast::ConditionSample;

constexpr std::size_t kCosts = 4;

/// Takes out the tests that are too vague for the services' forecasts, so that both tell the same.
std::vector<ConditionSample> take_vague(std::vector<ConditionSample>& history) {
  const double largest = prognostic_assessment::Options{}.largest_condition_std;
  const auto vague = std::stable_partition(
      history.begin(), history.end(), [&](const ConditionSample& sample) { return sample.condition_std <= largest; });
  std::vector<ConditionSample> taken(vague, history.end());
  history.erase(vague, history.end());
  return taken;
}

bool take_dates(const ForecastOptions& options, forecast::ForecastRequest& request) {
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

/// Campaigns, costs and forecasters that the configuration has for the asset's site.
bool take_site(const ForecastOptions& options, const std::optional<AssetConfig>& asset, ForecastQuestion& question) {
  if (options.config.empty()) return true;
  if (!asset) {
    complain(Error{.file = {},
                   .place = "--config",
                   .value = options.config,
                   .rule = "needs --asset, whose site says which campaigns are meant",
                   .advice = {}});
    return false;
  }
  const std::optional<Configuration> configuration = load_or_explain(options.config);
  if (!configuration) return false;
  if (configuration->find_site(asset->site) == nullptr) {
    complain(Error{.file = options.config,
                   .place = "key sites",
                   .value = asset->site,
                   .rule = "is the site of asset " + asset->asset_id + " and is not there",
                   .advice = {}});
    return false;
  }
  take_site(*configuration, asset->site, question);
  question.forecasters = forecast::configured_forecasters(*configuration);
  return true;
}

bool take_costs(const ForecastOptions& options, ForecastQuestion& question) {
  if (options.costs.empty()) return true;
  const std::vector<double>& c = options.costs;
  const auto wrong = [](std::string value, std::string rule) {
    complain(Error{.file = {},
                   .place = "--costs",
                   .value = std::move(value),
                   .rule = std::move(rule),
                   .advice = "PLANNED,AFTER_FAILURE,FAILED_MONTH,UNUSED_MONTH in one currency, as 10,50,2,0.2"});
    return false;
  };
  if (c.size() != kCosts) return wrong(std::to_string(c.size()) + " numbers", "must be four numbers");
  question.costs =
      SiteCosts{.planned = c[0], .after_failure = c[1], .failed_month = c[2], .unused_month = c[3], .currency = {}};
  if (const Status valid = intervention_costs(question).validate(); !valid)
    return wrong(valid.error().value, valid.error().place + " " + valid.error().rule);
  return true;
}

bool sensible_threshold(double threshold) {
  if (threshold > 0.0 && threshold <= 1.0) return true;
  complain(Error{.file = {},
                 .place = "--threshold",
                 .value = number(threshold),
                 .rule = "must be above 0, at most 1",
                 .advice = "0.6 for a part that has failed at a condition of 60 %"});
  return false;
}

/// The asset that --asset names by its file.
std::optional<AssetConfig> asset_in_file(const std::string& file) {
  std::error_code none;
  if (std::filesystem::exists(file, none)) return load_asset_or_explain(file);
  complain(Error{.file = {},
                 .place = "--asset",
                 .value = file,
                 .rule = "is not a file",
                 .advice = "give an asset file, for example --asset config/assets/xt03-mv2.yaml"});
  return std::nullopt;
}

std::optional<ForecastQuestion> question_of_file(const ForecastOptions& options) {
  std::optional<AssetConfig> asset;
  if (!options.asset.empty() && !(asset = asset_in_file(options.asset))) return std::nullopt;
  const std::optional<ConditionSetting> seal = asset ? asset->condition : std::nullopt;
  auto history = forecast::read_history(options.history_file, seal);
  if (!history) {
    complain(history.error());
    return std::nullopt;
  }
  ForecastQuestion question{
      .request = {.history = std::move(*history),
                  .threshold = options.threshold_given || !seal ? options.threshold : seal->threshold},
      .asset_id = asset ? asset->asset_id : "",
      .part = seal ? seal->part : "piston seal",
      .worn_parameter = seal ? seal->parameter : "leakage",
      .forecasters = forecast::default_forecasters()};
  forecast::ForecastRequest& request = question.request;
  question.tests = request.history.size();
  question.first = request.history.front().time;
  question.last = request.now = request.history.back().time;
  question.vague = take_vague(request.history);
  question.without_error = static_cast<std::size_t>(
      std::count_if(request.history.begin(), request.history.end(),
                    [](const ConditionSample& sample) { return sample.condition_std == 0.0; }));
  if (!take_site(options, asset, question)) return std::nullopt;
  return question;
}

/// The id that is meant: the one that is given, or of the only asset that has been tested.
std::optional<std::string> asset_id_in(StateJournals& journals, const std::string& given) {
  const auto tested = journals.assets(Topic::leakage_estimate);
  if (!tested) {
    complain(tested.error());
    return std::nullopt;
  }
  if (given.empty() && tested->size() == 1) return tested->front();
  if (std::ranges::find(*tested, given) != tested->end()) return given;
  complain(Error{.file = journals.place(),
                 .place = "--asset",
                 .value = given,
                 .rule = tested->empty() ? "no test of any asset has been concluded here"
                         : given.empty() ? "must say which asset is meant"
                                         : "is not an asset that has been tested here",
                 .advice = tested->empty() ? "replay its recordings first" : suggest(given, *tested)});
  return std::nullopt;
}

/// The asset whose history is asked for: its file, or its id in the configuration.
std::optional<AssetConfig> asset_of_journals(const std::string& given, const Configuration& configuration,
                                             StateJournals& journals) {
  if (std::error_code none; std::filesystem::is_regular_file(given, none)) return load_asset_or_explain(given);
  const std::optional<std::string> asset_id = asset_id_in(journals, given);
  if (!asset_id) return std::nullopt;
  if (const AssetConfig* asset = configuration.find_asset(*asset_id)) return *asset;
  complain(Error{.file = {},
                 .place = {},
                 .value = *asset_id,
                 .rule = "is not a configured asset: what wears and its site are not known",
                 .advice = "give the configuration of the services with --config"});
  return std::nullopt;
}

/// From what the services keep, as they ask it themselves.
std::optional<ForecastQuestion> question_of_journals(const ForecastOptions& options) {
  const std::string config = options.config.empty() ? default_config() : options.config;
  const std::optional<Configuration> configuration = load_or_explain(config);
  if (!configuration) return std::nullopt;
  std::optional<StateJournals> journals = StateJournals::open(options.state_directory, config);
  if (!journals) return std::nullopt;
  const std::optional<AssetConfig> asset = asset_of_journals(options.asset, *configuration, *journals);
  if (!asset) return std::nullopt;
  const std::optional<ConcludedHistory> history = history_in(*journals, asset->asset_id);
  if (!history) return std::nullopt;
  std::optional<ForecastQuestion> question = history->question(*asset, *configuration);
  if (!question)
    complain(Error{.file = journals->place(),
                   .place = {},
                   .value = asset->asset_id,
                   .rule = asset->condition ? "has no test with a date since its last replacement"
                                            : "has no condition by its asset file: nothing is forecast",
                   .advice = {}});
  if (question && options.threshold_given) question->request.threshold = options.threshold;
  return question;
}

}  // namespace

void take_site(const Configuration& configuration, const std::string& name, ForecastQuestion& question) {
  const SiteConfig* site = configuration.find_site(name);
  if (site == nullptr) return;
  for (const Campaign& campaign : site->campaigns)
    question.request.horizons.push_back({.label = campaign.label, .before = campaign.start});
  question.months_to_vessel = site->booking_lead_time_months;
  question.costs = configuration.decision_of(name).costs;
}

std::string history_words(const ForecastQuestion& question) {
  if (question.tests == 0 && question.request.installed)
    return "replaced on " + format_date(*question.request.installed) + ", no test since";
  return count_of(question.tests, "test") + ", " + format_date(question.first) + " to " + format_date(question.last);
}

Result<forecast::ForecastPanel::Answer> answer_of(const ForecastQuestion& question) {
  const auto panel = forecast::ForecastPanel::make(question.forecasters);
  if (!panel) return fail(panel.error());
  auto answer = panel->forecast(question.request);
  if (answer && question.tests == 0)
    for (Forecast& forecast : answer->forecasts) forecast.explanation = history_words(question);
  return answer;
}

bool tells_probability(const Forecast& forecast) {
  return forecast.state == ForecastState::ok || forecast.state == ForecastState::past_threshold;
}

forecast::InterventionCosts intervention_costs(const ForecastQuestion& question) {
  const SiteCosts costs = question.costs.value_or(SiteCosts{});
  return {.planned = costs.planned,
          .after_failure = costs.after_failure,
          .failed_month = costs.failed_month,
          .unused_month = costs.unused_month,
          .months_to_vessel = question.months_to_vessel};
}

std::optional<ForecastQuestion> forecast_question(const ForecastOptions& options) {
  auto question = options.history_file.empty() ? question_of_journals(options) : question_of_file(options);
  if (!question || !sensible_threshold(question->request.threshold) || !take_dates(options, question->request) ||
      !take_costs(options, *question))
    return std::nullopt;
  std::stable_sort(question->request.horizons.begin(), question->request.horizons.end(),
                   [](const auto& a, const auto& b) { return a.before < b.before; });
  return question;
}

std::vector<DecisionOption> decision_of(const ForecastQuestion& question,
                                        const forecast::ForecastPanel::Answer& answer) {
  if (!answer.distributions.front()) return {};
  const UtcTime now = question.request.now;
  std::vector<forecast::Candidate> candidates{{.label = "now", .months = 0.0}};
  for (const forecast::FailureHorizon& horizon : question.request.horizons)
    if (horizon.before > now)
      candidates.push_back({.label = horizon.label, .months = months_between(now, horizon.before)});
  const auto decision =
      forecast::weigh_candidates(*answer.distributions.front(), candidates, intervention_costs(question));
  if (!decision) return {};
  std::vector<DecisionOption> options;
  for (std::size_t k = 0; k < decision->rows.size(); ++k) {
    const forecast::DecisionRow& row = decision->rows[k];
    options.push_back({.label = row.label,
                       .at_ns = row.date(now).nanoseconds,
                       .months = row.months,
                       .failure_probability = row.failure_probability,
                       .cost_known = question.costs.has_value(),
                       .expected_cost = question.costs ? row.expected_cost : 0.0,
                       .currency = question.costs ? question.costs->currency : "",
                       .cheapest = question.costs && k == decision->cheapest});
  }
  return options;
}

}  // namespace sealwatch::cli

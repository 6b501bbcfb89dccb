#include "services/prognostic_assessment/prognostic_assessment.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "sealwatch/forecast/words.hpp"
#include "services/prognostic_assessment/judge_estimate.hpp"
#include "services/prognostic_assessment/pst_request.hpp"

namespace sealwatch::prognostic_assessment {
namespace {

constexpr const char* kProducer = "prognostic_assessment 0.1.0";
constexpr std::array kInputs{Topic::health_report, Topic::test_window, Topic::maintenance_event};
constexpr std::array kOutputs{Topic::leakage_estimate, Topic::remaining_life, Topic::pst_request};
constexpr std::size_t kMostSources = 60;  // five years of monthly estimates: more than any window

Header header_for(const std::string& topic, const Header& cause, std::vector<std::string> source_ids) {
  Header header;
  header.message_id = topic + "/" + (cause.pst_id.empty() ? cause.message_id : cause.pst_id);
  header.pst_id = cause.pst_id;
  header.source_ids = std::move(source_ids);
  header.producer = kProducer;
  header.event_time_known = cause.event_time_known;
  header.event_time_ns = cause.event_time_ns;
  header.replay = cause.replay;
  return header;
}

std::string estimate_id(const std::string& pst_id) { return "leakage_estimate/" + pst_id; }

std::string dates_after(const std::vector<forecast::ConditionSample>& samples, UtcTime begin) {
  std::string text;
  for (const forecast::ConditionSample& sample : samples)
    if (sample.time > begin)
      text +=
          (text.empty() ? "" : ", ") + format_date(sample.time) + " (" + forecast::as_condition(sample.condition) + ")";
  return text;
}

/// The latest estimates behind a remaining life, newest first.
std::vector<std::string> estimate_ids(const std::vector<HistoryEntry>& entries) {
  std::vector<std::string> ids;
  for (auto entry = entries.rbegin(); entry != entries.rend() && ids.size() < kMostSources; ++entry)
    if (entry->eligible) ids.push_back(entry->estimate_id);
  return ids;
}

void mark_unconfirmed(LeakageEstimate& estimate, const std::vector<forecast::ConditionSample>& left_out) {
  const UtcTime time{estimate.header.event_time_ns};
  const bool alone = std::any_of(left_out.begin(), left_out.end(), [&](const auto& sample) {
    return sample.time == time && sample.condition == estimate.condition;
  });
  if (!alone || !estimate.used_for_forecast) return;
  estimate.used_for_forecast = false;
  estimate.reasons.push_back(kUnconfirmed + std::string("theta = ") + forecast::as_condition(estimate.condition) +
                             " is more than five robust standard deviations off its neighbours; it counts "
                             "once the next test confirms it");
}

}  // namespace

Status Options::validate() const {
  if (!(largest_condition_std > 0.0))
    return fail(Error{.file = {},
                      .place = "largest_condition_std",
                      .value = std::to_string(largest_condition_std),
                      .rule = "must be positive",
                      .advice = {}});
  if (const auto panel = forecast::ForecastPanel::make(forecasters); !panel) return fail(panel.error());
  return {};
}

Result<std::unique_ptr<PrognosticAssessment>> PrognosticAssessment::make(const Configuration& configuration,
                                                                         const Estimator& estimator,
                                                                         const Options& options) {
  if (const Status valid = options.validate(); !valid) return fail(valid.error());
  auto panel = forecast::ForecastPanel::make(options.forecasters);
  return std::unique_ptr<PrognosticAssessment>(
      new PrognosticAssessment(configuration, estimator, options, std::move(*panel)));
}

std::span<const Topic> PrognosticAssessment::inputs() const { return kInputs; }
std::span<const Topic> PrognosticAssessment::outputs() const { return kOutputs; }

void PrognosticAssessment::restore(const Message& own_output) {
  if (const auto* estimate = std::get_if<LeakageEstimate>(&own_output)) history_[estimate->asset_id].add(*estimate);
  if (const auto* life = std::get_if<RemainingLife>(&own_output); life && life->header.pst_id.empty())
    history_[life->asset_id].add_replacement({life->header.event_time_ns});
}

Conclusion PrognosticAssessment::receive(const Message& input) {
  if (const auto* health = std::get_if<HealthReport>(&input)) return join(*health, &Pending::health);
  if (const auto* window = std::get_if<TestWindow>(&input)) return join(*window, &Pending::window);
  if (const auto* event = std::get_if<MaintenanceEvent>(&input)) return replaced(*event);
  return {.outputs = {}, .consumed = {header_of(input).message_id}};
}

template <class Input>
Conclusion PrognosticAssessment::join(const Input& input, std::optional<Input> Pending::*slot) {
  const std::string& pst_id = input.header.pst_id;
  if (pst_id.empty() || history_[input.asset_id].has_estimate(estimate_id(pst_id)))
    return {.outputs = {}, .consumed = {input.header.message_id}};
  Pending& test = pending_[pst_id];
  test.*slot = input;
  if (!test.health || !test.window) return {};
  Conclusion conclusion;
  conclusion.outputs = conclude(*test.health, *test.window);
  conclusion.consumed = {test.health->header.message_id, test.window->header.message_id};
  pending_.erase(pst_id);
  return conclusion;
}

std::vector<Message> PrognosticAssessment::conclude(const HealthReport& health, const TestWindow& window) {
  LeakageEstimate leakage = estimate(health, window);
  leakage.header = header_for("leakage_estimate", health.header, {health.header.message_id, window.header.message_id});
  const RemainingLife life = remaining_life(leakage);
  std::vector<Message> outputs{leakage, life};
  AssetHistory& history = history_[leakage.asset_id];
  const AssetConfig* asset = configuration_.find_asset(leakage.asset_id);
  const bool latest = leakage.header.event_time_known && !history.has_later_than({leakage.header.event_time_ns});
  if (asset && latest) {
    PstRequest request = next_test(*asset, leakage);
    request.header = header_for("pst_request", health.header, {leakage.header.message_id});
    outputs.emplace_back(std::move(request));
  }
  history.add(leakage);
  return outputs;
}

LeakageEstimate PrognosticAssessment::estimate(const HealthReport& health, const TestWindow& window) const {
  if (const AssetConfig* asset = configuration_.find_asset(health.asset_id))
    return judge_estimate(*asset, health, estimator_.estimate(*asset, window.samples, window.phases),
                          options_.largest_condition_std);
  LeakageEstimate estimate;
  estimate.asset_id = health.asset_id;
  estimate.reasons.push_back("asset '" + health.asset_id + "' is not configured");
  return estimate;
}

RemainingLife PrognosticAssessment::remaining_life(LeakageEstimate& leakage) const {
  RemainingLife life;
  life.asset_id = leakage.asset_id;
  life.header = header_for("remaining_life", leakage.header, {leakage.header.message_id});
  const AssetConfig* asset = configuration_.find_asset(leakage.asset_id);
  if (!asset || !asset->seal || !leakage.header.event_time_known) {
    life.forecasts = no_forecast(leakage.reasons.empty() ? "no estimate" : leakage.reasons.back());
    return life;
  }
  const UtcTime now{leakage.header.event_time_ns};
  AssetHistory history = history_.contains(asset->asset_id) ? history_.at(asset->asset_id) : AssetHistory{};
  history.add(leakage);
  const std::vector<HistoryEntry> tests = history.until(now);
  forecast::ForecastRequest request{.threshold = asset->seal->threshold,
                                    .now = now,
                                    .installed = history.replaced_before(now),
                                    .horizons = campaigns(*asset)};
  for (const HistoryEntry& test : tests)
    if (test.eligible) request.history.push_back(test.sample);
  forecast::ForecastPanel::Answer answer = panel_.forecast(request);
  mark_unconfirmed(leakage, answer.left_out);
  life.threshold = asset->seal->threshold;
  life.tests_since_replacement = static_cast<std::int32_t>(tests.size());
  life.header.source_ids = estimate_ids(tests);
  if (!answer.used.empty()) {
    life.condition_known = true;
    life.condition = answer.used.back().condition;
    life.condition_std = answer.used.back().condition_std;
  }
  life.forecasts = std::move(answer.forecasts);
  life.windows_disagree = answer.windows_disagree;
  life.disagreement = answer.disagreement;
  for (Forecast& forecast : life.forecasts) {
    const std::string alone = dates_after(answer.left_out, add_months(now, -forecast.window_months));
    if (!alone.empty()) forecast.explanation += "; left out because they stand alone: " + alone;
  }
  return life;
}

Conclusion PrognosticAssessment::replaced(const MaintenanceEvent& event) {
  Conclusion conclusion{.outputs = {}, .consumed = {event.header.message_id}};
  if (!event.header.event_time_known) return conclusion;  // without its time it cannot part the history
  RemainingLife life;
  life.asset_id = event.asset_id;
  life.header = header_for("remaining_life", event.header, {event.header.message_id});
  life.header.pst_id.clear();
  const UtcTime time{event.header.event_time_ns};
  const AssetConfig* asset = configuration_.find_asset(event.asset_id);
  if (asset && asset->seal) life.threshold = asset->seal->threshold;
  life.forecasts = no_forecast(event.kind + " on " + format_date(time) + ": the history starts anew");
  history_[event.asset_id].add_replacement(time);
  conclusion.outputs.emplace_back(std::move(life));
  return conclusion;
}

std::vector<forecast::FailureHorizon> PrognosticAssessment::campaigns(const AssetConfig& asset) const {
  std::vector<forecast::FailureHorizon> horizons;
  if (const SiteConfig* site = configuration_.find_site(asset.site))
    for (const Campaign& campaign : site->campaigns) horizons.push_back({campaign.label, campaign.start});
  return horizons;
}

std::vector<Forecast> PrognosticAssessment::no_forecast(const std::string& explanation) const {
  std::vector<Forecast> forecasts;
  for (const forecast::ForecasterSettings& settings : options_.forecasters) {
    Forecast forecast;
    forecast.method = settings.method;
    forecast.window_months = settings.window_months;
    forecast.explanation = explanation;
    forecasts.push_back(std::move(forecast));
  }
  return forecasts;
}

}  // namespace sealwatch::prognostic_assessment

#include "services/prognostic_assessment/prognostic_assessment.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "sealwatch/forecast/decision.hpp"
#include "sealwatch/message/provenance.hpp"
#include "sealwatch/message/worn_words.hpp"
#include "services/common/text/numbers.hpp"
#include "services/common/text/words.hpp"
#include "services/prognostic_assessment/judge_estimate.hpp"
#include "services/prognostic_assessment/pst_request.hpp"
#include "services/prognostic_assessment/self_scoring.hpp"

namespace sealwatch::prognostic_assessment {
namespace {

constexpr std::array kInputs{Topic::health_report, Topic::test_window, Topic::maintenance_event,
                             Topic::model_discrepancy, Topic::model_acceptance};
constexpr std::array kOutputs{Topic::leakage_estimate, Topic::remaining_life, Topic::pst_request};
constexpr std::size_t kMostSources = 240;  // twenty years of monthly estimates: the longest window of a forecaster

std::string estimate_id(const std::string& pst_id) { return "leakage_estimate/" + pst_id; }

std::string dates_after(const std::vector<forecast::ConditionSample>& samples, UtcTime begin) {
  std::string text;
  for (const forecast::ConditionSample& sample : samples)
    if (sample.time > begin)
      text::add_to_list(text, format_date(sample.time) + " (" + text::condition_in_percent(sample.condition) + ")");
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
  estimate.reasons.push_back(kUnconfirmed + std::string("the ") + worn_condition(estimate) + ", " +
                             text::condition_in_percent(estimate.condition) +
                             ", is more than five robust standard deviations off its neighbours; it counts "
                             "once the next test confirms it");
}

}  // namespace

Status Options::validate() const {
  if (!(largest_condition_std > 0.0))
    return fail(Error{.file = {},
                      .place = "largest_condition_std",
                      .value = text::general(largest_condition_std),
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
  auto in_charge = forecast::make_forecaster(options.forecasters.front());
  return std::unique_ptr<PrognosticAssessment>(
      new PrognosticAssessment(configuration, estimator, options, std::move(*panel), std::move(*in_charge)));
}

std::span<const Topic> PrognosticAssessment::inputs() const { return kInputs; }
std::span<const Topic> PrognosticAssessment::outputs() const { return kOutputs; }

void PrognosticAssessment::restore(const Message& own_output) {
  if (const auto* estimate = std::get_if<LeakageEstimate>(&own_output)) remember(*estimate);
  if (const auto* life = std::get_if<RemainingLife>(&own_output)) learn_retractions(life->asset_id, life->header);
  if (const auto* life = std::get_if<RemainingLife>(&own_output); life && life->replacement_known) {
    history_[life->asset_id].add_replacement(replacement_of(*life));
    learn_replacements(life->asset_id, life->header);
  }
  if (const auto* record = std::get_if<ActRecord>(&own_output))
    for (const MaintenanceEvent& event : record->events)
      if (event.tests_known) history_[event.asset_id].name_tests(event.header.message_id, event.test_ids);
}

void PrognosticAssessment::meet(const std::string& asset_id, const std::string& pst_id) {
  if (history_[asset_id].meet(pst_id)) latest_.erase(asset_id);
}

void PrognosticAssessment::remember(const LeakageEstimate& estimate) {
  meet(estimate.asset_id, estimate.header.pst_id);
  if (estimate.header.event_time_known && history_[estimate.asset_id].counts(estimate.header.pst_id)) {
    const auto known = latest_.find(estimate.asset_id);
    if (known == latest_.end() || known->second.header.event_time_ns <= estimate.header.event_time_ns)
      latest_[estimate.asset_id] = estimate;
  }
  history_[estimate.asset_id].add(estimate);
}

Conclusion PrognosticAssessment::receive(const Message& input) { return receive_until(input, {}); }

Conclusion PrognosticAssessment::receive_until(const Message& input, const std::stop_token& stop) {
  if (const auto* health = std::get_if<HealthReport>(&input)) return join(*health, &Pending::health, stop);
  if (const auto* window = std::get_if<TestWindow>(&input)) return join(*window, &Pending::windows, stop);
  if (const auto* event = std::get_if<MaintenanceEvent>(&input))
    return is_replacement(*event) ? replaced(*event) : retracted(*event);
  Conclusion conclusion;
  if (const auto* found = std::get_if<ModelDiscrepancy>(&input))
    return accepted_[found->asset_id].take(*found, conclusion), conclusion;
  if (const auto* acceptance = std::get_if<ModelAcceptance>(&input))
    return accepted_[acceptance->asset_id].take(*acceptance, conclusion), conclusion;
  return {.outputs = {}, .consumed = {header_of(input).message_id}};
}

template <class Input>
Conclusion PrognosticAssessment::join(const Input& input, Halves<Input> Pending::*halves, const std::stop_token& stop) {
  const std::string& pst_id = input.header.pst_id;
  if (pst_id.empty() || history_[input.asset_id].has_estimate(estimate_id(pst_id)))
    return {.outputs = {}, .consumed = {input.header.message_id}};
  Conclusion conclusion;
  Pending& pending = pending_[input.asset_id];
  (pending.*halves).add(input, conclusion);
  if (!pending.health.has(pst_id) || !pending.windows.has(pst_id)) return conclusion;
  if (!pending.health.is_here(pst_id, conclusion) || !pending.windows.is_here(pst_id, conclusion)) return conclusion;
  const HealthReport health = pending.health.take(pst_id, conclusion);
  const TestWindow window = pending.windows.take(pst_id, conclusion);
  conclusion.outputs = conclude(health, window, stop);
  conclusion.consumed.push_back(health.header.message_id);
  conclusion.consumed.push_back(window.header.message_id);
  return conclusion;
}

std::vector<Message> PrognosticAssessment::conclude(const HealthReport& health, const TestWindow& window,
                                                    const std::stop_token& stop) {
  learn_replacements(health.asset_id, health.header);
  meet(health.asset_id, health.header.pst_id);
  LeakageEstimate leakage = estimate(health, window, stop);
  leakage.header = concluded_from(health.header, "leakage_estimate", kProducer,
                                  {health.header.message_id, window.header.message_id});
  const RemainingLife life = remaining_life(leakage);
  std::vector<Message> outputs{leakage, life};
  const AssetHistory& history = history_[leakage.asset_id];
  const AssetConfig* asset = configuration_.find_asset(leakage.asset_id);
  const UtcTime tested{leakage.header.event_time_ns};
  const bool latest = leakage.header.event_time_known && !history.has_later_than(tested);
  const Replacement* const replaced = history.last_replacement();
  if (asset && latest && (replaced == nullptr || replaced->time <= tested)) {
    PstRequest request = next_test(*asset, leakage);
    request.header = concluded_from(health.header, "pst_request", kProducer, {leakage.header.message_id});
    outputs.emplace_back(std::move(request));
  }
  remember(leakage);
  return outputs;
}

LeakageEstimate PrognosticAssessment::estimate(const HealthReport& health, const TestWindow& window,
                                               const std::stop_token& stop) const {
  LeakageEstimate estimate;
  if (const AssetConfig* nominal = configuration_.find_asset(health.asset_id)) {
    const AcceptedModel& model = accepted(health.asset_id);
    const AssetConfig asset = model.applied_to(*nominal);
    estimate = judge_estimate(asset, health, estimator_.estimate(asset, window.samples, window.phases, stop),
                              options_.largest_condition_std);
    estimate.accepted_discrepancy = model.discrepancy_id();
    return estimate;
  }
  estimate.asset_id = health.asset_id;
  estimate.reasons.push_back("asset '" + health.asset_id + "' is not configured");
  return estimate;
}

RemainingLife PrognosticAssessment::remaining_life(LeakageEstimate& leakage) const {
  RemainingLife life;
  life.asset_id = leakage.asset_id;
  life.header = concluded_from(leakage.header, "remaining_life", kProducer, {leakage.header.message_id});
  const AssetConfig* asset = configuration_.find_asset(leakage.asset_id);
  if (!asset || !asset->condition || !leakage.header.event_time_known) {
    life.forecasts = no_forecast(leakage.reasons.empty() ? "no estimate" : leakage.reasons.back());
    return life;
  }
  const UtcTime now{leakage.header.event_time_ns};
  AssetHistory history = history_.contains(asset->asset_id) ? history_.at(asset->asset_id) : AssetHistory{};
  if (!history.has_estimate(leakage.header.message_id)) history.add(leakage);
  const std::vector<HistoryEntry> tests = history.until(now);
  const Replacement* const replaced = history.replaced_before(now);
  forecast::ForecastRequest request{.threshold = asset->condition->threshold,
                                    .now = now,
                                    .installed = replaced == nullptr ? std::nullopt : std::optional(replaced->time),
                                    .horizons = campaigns(*asset)};
  for (const HistoryEntry& test : tests)
    if (test.eligible) request.history.push_back(test.sample);
  auto answered = panel_.forecast(request);
  if (!answered) {
    life.forecasts = no_forecast(answered.error().describe());
    return life;
  }
  forecast::ForecastPanel::Answer& answer = *answered;
  mark_unconfirmed(leakage, answer.left_out);
  life.threshold = asset->condition->threshold;
  life.tests_since_replacement = static_cast<std::int32_t>(tests.size());
  life.header.source_ids = estimate_ids(tests);
  if (replaced != nullptr) tell_of(*replaced, life);
  if (!answer.used.empty()) {
    life.condition_known = true;
    life.condition = answer.used.back().condition;
    life.condition_std = answer.used.back().condition_std;
  }
  request.history = answer.used;
  score(*in_charge_, request, life);
  add_decision(*asset, now, answer, life);
  if (life.scored_forecasts == 0 && answer.forecasts.front().state != ForecastState::ok) life.confidence = 0.0;
  life.forecasts = std::move(answer.forecasts);
  life.windows_disagree = answer.windows_disagree;
  life.disagreement = answer.disagreement;
  for (Forecast& forecast : life.forecasts) {
    const std::string alone = dates_after(answer.left_out, add_months(now, -forecast.window_months));
    if (!alone.empty()) forecast.explanation += "; left out because they stand alone: " + alone;
  }
  return life;
}

const AcceptedModel& PrognosticAssessment::accepted(const std::string& asset_id) const {
  static const AcceptedModel none;
  const auto found = accepted_.find(asset_id);
  return found == accepted_.end() ? none : found->second;
}

std::size_t PrognosticAssessment::held() const {
  std::size_t held = 0;
  for (const auto& [asset_id, model] : accepted_) held += model.held();
  for (const auto& [asset_id, pending] : pending_) held += pending.health.overtaken() + pending.windows.overtaken();
  return held;
}

std::vector<Refusal> PrognosticAssessment::waiting() const {
  std::vector<Refusal> all;
  for (const auto& [asset_id, model] : accepted_) std::ranges::move(model.waiting(), std::back_inserter(all));
  return all;
}

Conclusion PrognosticAssessment::tick(UtcTime now) {
  Conclusion conclusion;
  for (auto& [asset_id, model] : accepted_) model.tick(now, conclusion);
  return conclusion;
}

std::vector<forecast::FailureHorizon> PrognosticAssessment::campaigns(const AssetConfig& asset) const {
  std::vector<forecast::FailureHorizon> horizons;
  if (const SiteConfig* site = configuration_.find_site(asset.site))
    for (const Campaign& campaign : site->campaigns) horizons.push_back({campaign.label, campaign.start});
  return horizons;
}

void PrognosticAssessment::add_decision(const AssetConfig& asset, UtcTime now,
                                        const forecast::ForecastPanel::Answer& answer, RemainingLife& life) const {
  if (!answer.distributions.front()) return;
  const SiteConfig* site = configuration_.find_site(asset.site);
  const std::optional<SiteCosts> given = configuration_.decision_of(asset.site).costs;
  const SiteCosts costs = given.value_or(SiteCosts{});
  const forecast::InterventionCosts weights{
      .planned = costs.planned,
      .after_failure = costs.after_failure,
      .failed_month = costs.failed_month,
      .unused_month = costs.unused_month,
      .months_to_vessel = site ? site->booking_lead_time_months : SiteConfig{}.booking_lead_time_months};
  std::vector<forecast::Candidate> candidates{{.label = "now", .months = 0.0}};
  for (const forecast::FailureHorizon& campaign : campaigns(asset))
    if (campaign.before > now)
      candidates.push_back({.label = campaign.label, .months = months_between(now, campaign.before)});
  const auto decision = forecast::weigh_candidates(*answer.distributions.front(), candidates, weights);
  if (!decision) return;
  for (std::size_t k = 0; k < decision->rows.size(); ++k) {
    const forecast::DecisionRow& row = decision->rows[k];
    life.decision.push_back({.label = row.label,
                             .at_ns = row.date(now).nanoseconds,
                             .months = row.months,
                             .failure_probability = row.failure_probability,
                             .cost_known = given.has_value(),
                             .expected_cost = given ? row.expected_cost : 0.0,
                             .currency = costs.currency,
                             .cheapest = given && k == decision->cheapest});
  }
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

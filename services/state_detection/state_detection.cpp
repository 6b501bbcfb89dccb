#include "services/state_detection/state_detection.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "sealwatch/message/retraction.hpp"
#include "sealwatch/model/too_long_to_simulate.hpp"
#include "services/common/text/format.hpp"
#include "services/common/text/numbers.hpp"
#include "services/state_detection/indicators.hpp"
#include "services/state_detection/judgements.hpp"
#include "services/state_detection/residual.hpp"
#include "services/state_detection/rules.hpp"
#include "services/state_detection/verdict.hpp"

namespace sealwatch {
namespace {

constexpr const char* kProducer = "state_detection 0.1.0";
constexpr const char* kNoResidual = "no simulation residual: ";
/// An asset whose test has been overdue for longer is not in live operation: old recordings are being taken in.
constexpr double kLongestSilence_months = 12.0;
/// The tests of a history that is played back follow each other faster.
constexpr double kReplayIsOver_s = 600.0;

void add_source(Header& header, const Header& source) {
  const auto add = [&header](const std::string& id) {
    auto& ids = header.source_ids;
    if (!id.empty() && std::find(ids.begin(), ids.end(), id) == ids.end()) ids.push_back(id);
  };
  add(source.message_id);
  for (const std::string& id : source.source_ids) add(id);
}

bool is_first_after_replacement(const StateReport& report) {
  return std::ranges::any_of(report.header.source_ids, is_replacement_id);
}

/// What the report answers, if it answers a retraction: an id of the event comes first among its sources.
std::optional<Retraction> answered_retraction(const StateReport& report) {
  if (report.header.source_ids.empty() || !is_retraction_id(report.header.source_ids.front())) return std::nullopt;
  return retraction_answered_by(report);
}

/// Whether the maintenance was done before this test; unknown times count as before.
bool is_before(const MaintenanceEvent& event, const TestFeatures& test) {
  if (!event.header.event_time_known || !test.header.event_time_known) return true;
  return event.header.event_time_ns <= test.header.event_time_ns;
}

std::string days_text(double days) { return text::format("{:.0f} days", days); }

}  // namespace

Status StateDetectionOptions::validate() const {
  if (Status status = region.validate(); !status) return status;
  if (Status status = baseline.validate(); !status) return status;
  if (overdue_grace_share >= 0.0 && overdue_grace_share < 10.0) return {};
  return fail(Error{{},
                    "overdue_grace_share",
                    text::general(overdue_grace_share),
                    "must be in [0, 10)",
                    "it is a share of the test interval"});
}

StateDetection::StateDetection(std::span<const AssetConfig> assets, std::shared_ptr<const Simulator> simulator,
                               const StateDetectionOptions& options)
    : simulator_(std::move(simulator)), options_(options) {
  for (const AssetConfig& asset : assets) {
    assets_.emplace(asset.asset_id, asset);
    // Time passes for it from the start.
    if (options_.commissioned.contains(asset.asset_id)) static_cast<void>(state_of(asset.asset_id));
  }
}

std::span<const Topic> StateDetection::inputs() const {
  static constexpr std::array kInputs = {Topic::test_features, Topic::test_window, Topic::maintenance_event,
                                         Topic::model_discrepancy, Topic::model_acceptance};
  return kInputs;
}

std::span<const Topic> StateDetection::outputs() const {
  static constexpr std::array kOutputs = {Topic::state_report};
  return kOutputs;
}

StateDetection::AssetState& StateDetection::state_of(const std::string& asset_id) {
  return states_.try_emplace(asset_id, AssetState{AssetHistory(options_.region, options_.baseline), {}, {}, {}, {}, {}})
      .first->second;
}

void StateDetection::restore(const Message& own_output) {
  const auto* report = std::get_if<StateReport>(&own_output);
  if (report == nullptr) return;
  AssetState& state = state_of(report->asset_id);
  if (const auto retraction = answered_retraction(*report)) {
    state.past.apply(*retraction);
    static_cast<void>(judge_anew(report->asset_id, state));
    return;
  }
  if (state.past.meet(report->header.pst_id)) static_cast<void>(judge_anew(report->asset_id, state));
  AssetHistory& history = state.history;
  if (is_first_after_replacement(*report)) history.restart();
  if (!report->header.pst_id.empty()) history.use_accepted(report->accepted_discrepancy);
  if (std::vector<RegionJudgement> judgements = report->judgements; is_judged(report->verdict))
    history.judge(judgements);
  history.learn(*report);
  if (!report->header.pst_id.empty() && !state.past.add(*report))
    static_cast<void>(judge_anew(report->asset_id, state));
}

Conclusion StateDetection::receive(const Message& input) { return receive_until(input, {}); }

Conclusion StateDetection::receive_until(const Message& input, const std::stop_token& stop) {
  AssetState& state = state_of(asset_of(input));
  state.history.last_was_replay = header_of(input).replay;
  state.has_input = true;
  Conclusion conclusion;
  if (const auto* features = std::get_if<TestFeatures>(&input)) state.tests.add(*features, conclusion);
  if (const auto* window = std::get_if<TestWindow>(&input)) state.windows.add(*window, conclusion);
  if (const auto* event = std::get_if<MaintenanceEvent>(&input); event && !is_replacement(*event))
    return retracted(*event, state);
  if (const auto* event = std::get_if<MaintenanceEvent>(&input)) state.events.push_back(*event);
  if (const auto* event = std::get_if<MaintenanceEvent>(&input)) state.accepted.take(*event, conclusion);
  if (const auto* found = std::get_if<ModelDiscrepancy>(&input)) state.accepted.take(*found, conclusion);
  if (const auto* acceptance = std::get_if<ModelAcceptance>(&input)) state.accepted.take(*acceptance, conclusion);
  conclude_if_ready(state, header_of(input).pst_id, stop, conclusion);
  return conclusion;
}

std::optional<StateReport> StateDetection::judge_anew(const std::string& asset_id, AssetState& state) const {
  AssetConfig unknown;
  unknown.asset_id = asset_id;
  const auto asset = assets_.find(asset_id);
  AssetHistory fresh(options_.region, options_.baseline);
  std::optional<StateReport> last = state.past.judge_anew(asset == assets_.end() ? unknown : asset->second, fresh);
  fresh.last_was_replay = state.history.last_was_replay;
  fresh.last_overdue_id = state.history.last_overdue_id;
  state.history = std::move(fresh);
  return last;
}

/// The answer is a report of no test: on the last test that counts, as it is judged now.
Conclusion StateDetection::retracted(const MaintenanceEvent& event, AssetState& state) {
  Conclusion conclusion{.outputs = {}, .consumed = {event.header.message_id}};
  const auto retraction = retraction_of(event);
  if (!retraction) return conclusion;
  state.past.apply(*retraction);
  if (std::erase_if(state.events, [&](const auto& one) { return one.header.message_id == retraction->withdrawn_id; }))
    conclusion.consumed.push_back(retraction->withdrawn_id);
  StateReport report = judge_anew(event.asset_id, state).value_or(StateReport{});
  const std::string about = report.header.pst_id.empty() ? "no test counts" : "this is test " + report.header.pst_id;
  const Header judged = report.header;
  report.asset_id = event.asset_id;
  report.header = event.header;
  report.header.message_id = "state_report/" + event.header.message_id;
  report.header.producer = kProducer;
  name_tests(retraction->tests, report);
  report.header.source_ids = {event.header.message_id};
  if (!judged.message_id.empty()) report.header.source_ids.push_back(judged.message_id);
  if (judged.event_time_known) report.header.event_time_ns = judged.event_time_ns;
  report.verdict_reasons = {in_words(*retraction, event) + ": judged anew; " + about};
  conclusion.outputs.emplace_back(std::move(report));
  return conclusion;
}

void StateDetection::conclude_if_ready(AssetState& state, const std::string& pst_id, const std::stop_token& stop,
                                       Conclusion& conclusion) {
  if (!state.tests.has(pst_id) || !state.windows.has(pst_id)) return;
  if (!state.tests.is_here(pst_id, conclusion) || !state.windows.is_here(pst_id, conclusion)) return;
  const TestFeatures features = state.tests.take(pst_id, conclusion);
  const TestWindow window = state.windows.take(pst_id, conclusion);
  conclude(state, features, window, stop, conclusion);
  conclusion.consumed.push_back(features.header.message_id);
  conclusion.consumed.push_back(window.header.message_id);
}

void StateDetection::conclude(AssetState& state, const TestFeatures& features, const TestWindow& window,
                              const std::stop_token& stop, Conclusion& conclusion) {
  StateReport report;
  report.asset_id = features.asset_id;
  report.header = features.header;
  report.header.message_id = "state_report/" + features.header.pst_id;
  report.header.producer = kProducer;
  report.header.source_ids.clear();
  if (state.past.meet(report.header.pst_id)) static_cast<void>(judge_anew(report.asset_id, state));
  add_source(report.header, features.header);
  add_source(report.header, window.header);
  for (const MaintenanceEvent& event : state.events) {
    if (!is_before(event, features)) continue;
    add_source(report.header, event.header);
    state.history.restart();
    if (event.header.event_time_known) state.history.schedule.tested(UtcTime{event.header.event_time_ns});
  }
  report.accepted_discrepancy = state.accepted.discrepancy_id();
  state.history.use_accepted(report.accepted_discrepancy);
  const auto asset = assets_.find(features.asset_id);
  if (asset == assets_.end())
    report.verdict_reasons.push_back("asset '" + features.asset_id + "' is not in the configuration");
  else
    judge(state, asset->second, features, window, stop, report);
  report.region = state.history.worst_region();
  state.history.learn(report);
  if (!state.past.add(report))
    static_cast<void>(judge_anew(report.asset_id, state));  // it was retracted before it came
  if (is_judged(report.verdict))
    std::erase_if(state.events, [&](const MaintenanceEvent& event) {
      if (!is_before(event, features)) return false;
      conclusion.consumed.push_back(event.header.message_id);
      return true;
    });
  conclusion.outputs.push_back(std::move(report));
}

void StateDetection::judge(AssetState& state, const AssetConfig& asset, const TestFeatures& features,
                           const TestWindow& window, const std::stop_token& stop, StateReport& report) const {
  AssetHistory& history = state.history;
  std::vector<Quantity> indicators = condition_indicators(asset, features, window);
  Verdict verdict = judge_test(asset, features, window, indicators);
  report.verdict = verdict.verdict;
  report.verdict_reasons = std::move(verdict.reasons);
  note_lateness(state, asset, report);
  const std::set<std::string> expected = history.expected_channels();
  for (const ChannelStatus& stale : stale_channels(features.channel_status, expected)) {
    report.stale_channels.push_back(stale.channel);
    const bool was_ok = expected.contains(stale.channel);
    std::string text = "channel " + stale.channel + (was_ok ? ", OK in most earlier tests, " : ", never OK before, ");
    if (stale.state == ChannelState::NOT_USED)
      text += "was not recorded";
    else
      text.append("is ").append(name_of(stale.state)).append(stale.reason.empty() ? "" : ": ").append(stale.reason);
    report.verdict_reasons.push_back(std::move(text));
  }
  const auto too_long = simulator_ ? too_long_to_simulate(window.samples.time_s) : std::nullopt;
  if (too_long) refuse(*too_long, report);
  if (!is_judged(report.verdict)) return;
  const std::optional<double> worn =
      too_long ? std::nullopt : add_residuals(state, asset, features, window, stop, report);
  if (worn && !goes_by_leakage(asset))
    indicators.push_back({"condition", "1", asset.condition->condition(*worn), false, 0.0});
  report.judgements = judge_indicators(asset, indicators, history.baseline());
  for (RegionJudgement& judgement :
       judge_residuals(asset, report.residuals, history.baseline(), history.accepted_baseline()))
    report.judgements.push_back(std::move(judgement));
  for (RegionJudgement& judgement : judge_channels(asset, features.channel_status, expected))
    report.judgements.push_back(std::move(judgement));
  history.judge(report.judgements);
}

void StateDetection::refuse(const std::string& too_long, StateReport& report) {
  if (report.verdict == PstVerdict::failed) report.verdict_reasons.push_back(kNoResidual + too_long);
  if (report.verdict != PstVerdict::passed) return;
  report.verdict = PstVerdict::not_judged;
  report.verdict_reasons.insert(report.verdict_reasons.begin(), too_long);
}

std::optional<double> StateDetection::add_residuals(const AssetState& state, const AssetConfig& asset,
                                                    const TestFeatures& features, const TestWindow& window,
                                                    const std::stop_token& stop, StateReport& report) const {
  if (simulator_ == nullptr) return std::nullopt;
  const std::optional<double> leakage = feature_of(features, "leakage_resistance");
  const auto cannot = [&](const char* what, const Error& why) {
    report.verdict_reasons.push_back(what + why.describe());
  };
  Result<Residuals> residuals = residuals_of(asset, window, leakage, *simulator_, stop);
  if (residuals)
    report.residuals = std::move(residuals->summaries);
  else
    cannot(kNoResidual, residuals.error());
  if (state.accepted.in_force()) {
    const auto accepted = residuals_of_accepted(state.accepted.applied_to(asset), window, leakage, *simulator_, stop);
    if (accepted)
      report.residuals.insert(report.residuals.end(), accepted->begin(), accepted->end());
    else
      cannot("no residual of the accepted model: ", accepted.error());
  }
  return residuals ? residuals->nearest_wear : std::nullopt;
}

// An accepted model with what it was accepted from, a replacement until a test of the new actuator is judged, and what
// was overtaken.
std::size_t StateDetection::held() const {
  std::size_t held = 0;
  for (const auto& [asset_id, state] : states_)
    held += state.events.size() + state.accepted.held() + state.tests.overtaken() + state.windows.overtaken();
  return held;
}

std::vector<Refusal> StateDetection::waiting() const {
  std::vector<Refusal> all;
  for (const auto& [asset_id, state] : states_) std::ranges::move(state.accepted.waiting(), std::back_inserter(all));
  return all;
}

void StateDetection::note_lateness(const AssetState& state, const AssetConfig& asset, StateReport& report) const {
  if (!report.header.event_time_known) return;
  const auto late =
      state.history.schedule.lateness(UtcTime{report.header.event_time_ns}, asset.pst, options_.overdue_grace_share);
  if (!late) return;
  report.pst_overdue = true;
  report.overdue_days = late->days;
  report.verdict_reasons.push_back("this test came " + days_text(late->days) + " after it was due on " +
                                   format_date(late->due) + " (last judged test on " + format_date(late->last) + ")");
}

bool StateDetection::waits_for_first_live_test(const std::string& asset_id, const AssetState& state) const {
  return options_.commissioned.contains(asset_id) && !state.history.has_live_tests;
}

bool StateDetection::is_under_way(AssetState& state, UtcTime now) {
  if (std::exchange(state.has_input, false) || !state.quiet_since) state.quiet_since = now;
  return seconds_between(*state.quiet_since, now) < kReplayIsOver_s;
}

Conclusion StateDetection::tick(UtcTime now) {
  Conclusion conclusion;
  for (auto& [asset_id, state] : states_) {
    state.accepted.tick(now, conclusion);
    // A history that is played back is over. An asset that lives, or should, goes on beside it.
    const bool under_way = is_under_way(state, now);
    const bool is_history = state.history.last_was_replay && !state.history.has_live_tests;
    if (is_history && (under_way || !waits_for_first_live_test(asset_id, state))) continue;
    if (assets_.count(asset_id) == 0) continue;
    std::optional<StateReport> report = overdue_report(asset_id, state, now);
    if (!report || report->header.message_id == state.history.last_overdue_id) continue;
    state.history.learn(*report);
    conclusion.outputs.push_back(std::move(*report));
  }
  return conclusion;
}

std::optional<StateReport> StateDetection::overdue_report(const std::string& asset_id, const AssetState& state,
                                                          UtcTime now) const {
  Schedule schedule = state.history.schedule;
  for (const MaintenanceEvent& event : state.events)
    if (event.header.event_time_known) schedule.tested(UtcTime{event.header.event_time_ns});
  const auto commissioned = options_.commissioned.find(asset_id);
  const bool never_tested = !schedule.has_begun() && commissioned != options_.commissioned.end();
  if (never_tested) schedule.tested(commissioned->second);
  const PstSetting& pst = assets_.at(asset_id).pst;
  const auto overdue = schedule.overdue_from(pst, options_.overdue_grace_share);
  if (!overdue || now < *overdue) return std::nullopt;
  const bool is_old = add_months(*overdue, kLongestSilence_months) < now;
  if (is_old && !never_tested && !waits_for_first_live_test(asset_id, state)) return std::nullopt;
  const auto late = schedule.lateness(*overdue, pst, options_.overdue_grace_share);  // says nothing about `now`
  StateReport report;
  report.asset_id = asset_id;
  report.header.message_id = "state_report/" + asset_id + "/overdue/" + format_date(late->due);
  report.header.producer = kProducer;
  if (!state.history.last_judged_id.empty()) report.header.source_ids.push_back(state.history.last_judged_id);
  report.header.event_time_known = true;
  report.header.event_time_ns = overdue->nanoseconds;
  report.verdict_reasons.push_back("no test has been judged since " +
                                   std::string(never_tested ? "the asset was commissioned on " : "") +
                                   format_date(late->last) + "; one was due on " + format_date(late->due));
  report.region = std::max(AlertRegion::advisory, state.history.worst_region());
  report.pst_overdue = true;
  report.overdue_days = late->days;
  return report;
}

}  // namespace sealwatch

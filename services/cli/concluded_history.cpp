#include "services/cli/concluded_history.hpp"

#include <algorithm>
#include <map>

#include "sealwatch/forecast/configured.hpp"
#include "services/cli/session.hpp"
#include "services/prognostic_assessment/asset_history.hpp"

namespace sealwatch::cli {
namespace {

using prognostic_assessment::AssetHistory;
using prognostic_assessment::HistoryEntry;

const LeakageEstimate& estimate_of(const HistoryEntry& test, const std::vector<LeakageEstimate>& estimates) {
  return *std::ranges::find_if(
      estimates, [&](const LeakageEstimate& estimate) { return estimate.header.message_id == test.estimate_id; });
}

}  // namespace

void ConcludedHistory::take(const Message& message) {
  if (const auto* estimate = std::get_if<LeakageEstimate>(&message); estimate && estimate->header.event_time_known)
    estimates_.push_back(*estimate);
  if (const auto* life = std::get_if<RemainingLife>(&message)) {
    Told& told = told_.emplace_back(Told{.pst_id = life->header.pst_id, .retractions = {}, .replacement = {}});
    for (const std::string& source : life->header.source_ids)
      if (auto retraction = retraction_of(life->asset_id, source)) told.retractions.push_back(std::move(*retraction));
    if (life->replacement_known) told.replacement = prognostic_assessment::replacement_of(*life);
  }
  if (const auto* advice = std::get_if<Advisory>(&message); advice && advice->state != AdvisoryState::superseded)
    if (!advice_ || answers_retraction(advice->header) || advice->header.event_time_ns >= advice_->header.event_time_ns)
      advice_ = *advice;
}

// "All since a date" means the tests that are known when it is said.
AssetHistory ConcludedHistory::history() const {
  AssetHistory history;
  std::multimap<std::string, const LeakageEstimate*> by_test;
  for (const LeakageEstimate& estimate : estimates_) by_test.emplace(estimate.header.pst_id, &estimate);
  const auto add = [&](const std::string& pst_id) {
    const auto [first, last] = by_test.equal_range(pst_id);
    std::for_each(first, last, [&](const auto& one) { history.add(*one.second); });
    by_test.erase(first, last);
  };
  add("");
  for (const Told& told : told_) {
    add(told.pst_id);
    for (const Retraction& retraction : told.retractions) history.apply(retraction);
    if (told.replacement) history.add_replacement(*told.replacement);
  }
  for (const auto& [pst_id, estimate] : by_test) history.add(*estimate);
  return history;
}

std::optional<ForecastQuestion> ConcludedHistory::question(const AssetConfig& asset,
                                                           const Configuration& configuration) const {
  const AssetHistory history = this->history();
  UtcTime now{};
  if (const HistoryEntry* const last = history.last_counted()) now = last->sample.time;
  // A replacement that no test has followed yet ends the history too: the tests before it are of another seal.
  std::optional<UtcTime> replaced;
  if (const auto* const replacement = history.last_replacement()) replaced = replacement->time;
  if (replaced) now = std::max(now, *replaced);
  const std::vector<HistoryEntry> tests = history.until(now);
  if (!asset.condition || (tests.empty() && !replaced)) return std::nullopt;
  ForecastQuestion question{
      .request = {.threshold = asset.condition->threshold, .now = now, .installed = replaced, .horizons = {}},
      .asset_id = asset.asset_id,
      .part = asset.condition->part,
      .worn_parameter = asset.condition->parameter,
      .tests = tests.size(),
      .first = tests.empty() ? now : tests.front().sample.time,
      .last = now,
      .forecasters = forecast::configured_forecasters(configuration)};
  for (const HistoryEntry& test : tests) {
    if (test.eligible) {
      question.request.history.push_back(test.sample);
      continue;
    }
    const std::vector<std::string>& reasons = estimate_of(test, estimates_).reasons;
    question.not_counted.push_back({test.sample.time, reasons.empty() ? "no reason is given" : reasons.front()});
  }
  take_site(configuration, asset.site, question);
  if (advice_ && UtcTime{advice_->header.event_time_ns} >= now) question.advice = advice_;
  return question;
}

std::optional<ConcludedHistory> history_in(StateJournals& journals, const std::string& asset_id) {
  ConcludedHistory history;
  for (const Topic topic : {Topic::leakage_estimate, Topic::remaining_life, Topic::advisory}) {
    if (topic == Topic::advisory && !journals.journal_of(topic)) continue;  // that service runs elsewhere
    const auto messages = journals.all(topic, asset_id);
    if (!messages) {
      complain(messages.error());
      return std::nullopt;
    }
    for (const Message& message : *messages) history.take(message);
  }
  return history;
}

}  // namespace sealwatch::cli

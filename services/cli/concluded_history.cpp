#include "services/cli/concluded_history.hpp"

#include <algorithm>

#include "sealwatch/forecast/configured.hpp"
#include "services/cli/session.hpp"
#include "services/prognostic_assessment/asset_history.hpp"

namespace sealwatch::cli {
namespace {

using prognostic_assessment::HistoryEntry;

const LeakageEstimate& estimate_of(const HistoryEntry& test, const std::vector<LeakageEstimate>& estimates) {
  return *std::ranges::find_if(
      estimates, [&](const LeakageEstimate& estimate) { return estimate.header.message_id == test.estimate_id; });
}

}  // namespace

void ConcludedHistory::take(const Message& message) {
  if (const auto* estimate = std::get_if<LeakageEstimate>(&message); estimate && estimate->header.event_time_known)
    estimates_.push_back(*estimate);
  if (const auto* life = std::get_if<RemainingLife>(&message); life && life->replacement_known)
    replacements_.push_back({life->replaced_ns});
  if (const auto* advice = std::get_if<Advisory>(&message); advice && advice->state != AdvisoryState::superseded)
    if (!advice_ || advice->header.event_time_ns >= advice_->header.event_time_ns) advice_ = *advice;
}

std::optional<ForecastQuestion> ConcludedHistory::question(const AssetConfig& asset,
                                                           const Configuration& configuration) const {
  prognostic_assessment::AssetHistory history;
  for (const LeakageEstimate& estimate : estimates_) history.add(estimate);
  for (const UtcTime time : replacements_) history.add_replacement(time);
  UtcTime now{};
  for (const LeakageEstimate& estimate : estimates_) now = std::max(now, UtcTime{estimate.header.event_time_ns});
  // A replacement that no test has followed yet ends the history too: the tests before it are of another seal.
  const std::optional<UtcTime> replaced = history.last_replacement();
  if (replaced) now = std::max(now, *replaced);
  const std::vector<HistoryEntry> tests = history.until(now);
  if (!asset.condition || (tests.empty() && !replaced)) return std::nullopt;
  ForecastQuestion question{
      .request = {.threshold = asset.condition->threshold, .now = now, .installed = replaced, .horizons = {}},
      .asset_id = asset.asset_id,
      .part = asset.condition->part,
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

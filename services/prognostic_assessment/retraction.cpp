// What the retraction of tests does to the prognosis: it is concluded anew from those that still count.
#include "sealwatch/message/provenance.hpp"
#include "services/prognostic_assessment/prognostic_assessment.hpp"
#include "services/prognostic_assessment/pst_request.hpp"

namespace sealwatch::prognostic_assessment {
namespace {

constexpr std::string_view kEstimate = "leakage_estimate/";

/// What the history keeps of a test's estimate: all that a remaining life is concluded from.
LeakageEstimate estimate_of(const HistoryEntry& test, const std::string& asset_id) {
  LeakageEstimate estimate;
  estimate.asset_id = asset_id;
  estimate.header.message_id = test.estimate_id;
  estimate.header.pst_id = test.estimate_id.substr(kEstimate.size());
  estimate.header.event_time_known = true;
  estimate.header.event_time_ns = test.sample.time.nanoseconds;
  estimate.condition = test.sample.condition;
  estimate.condition_std = test.sample.condition_std;
  estimate.used_for_forecast = test.eligible;
  return estimate;
}

}  // namespace

/// The answer to a retraction names it: so it is known after a restart, at the same place among the tests.
void PrognosticAssessment::learn_retractions(const std::string& asset_id, const Header& header) {
  for (const std::string& source : header.source_ids)
    if (const auto retraction = retraction_of(asset_id, source)) apply(asset_id, *retraction);
}

void PrognosticAssessment::apply(const std::string& asset_id, const Retraction& retraction) {
  AssetHistory& history = history_[asset_id];
  history.apply(retraction);
  latest_.erase(asset_id);
  if (const HistoryEntry* last = history.last_counted()) latest_[asset_id] = estimate_of(*last, asset_id);
}

Conclusion PrognosticAssessment::retracted(const MaintenanceEvent& event) {
  Conclusion conclusion{.outputs = {}, .consumed = {event.header.message_id}};
  const auto retraction = retraction_of(event);
  if (!retraction) return conclusion;
  apply(event.asset_id, *retraction);
  const AssetConfig* asset = configuration_.find_asset(event.asset_id);
  const std::string what = in_words(*retraction, event);
  const auto latest = latest_.find(event.asset_id);
  RemainingLife life;
  life.asset_id = event.asset_id;
  if (latest != latest_.end()) {
    LeakageEstimate last = latest->second;
    life = remaining_life(last);
    for (Forecast& forecast : life.forecasts) forecast.explanation += "; " + what;
  } else {
    if (asset && asset->condition) life.threshold = asset->condition->threshold;
    life.forecasts = no_forecast(what + ": no test counts");
  }
  std::vector<std::string> sources = std::move(life.header.source_ids);
  sources.insert(sources.begin(), event.header.message_id);
  life.header = concluded_from(event.header, "remaining_life", kProducer, std::move(sources));
  life.header.pst_id.clear();
  if (latest != latest_.end()) life.header.event_time_ns = latest->second.header.event_time_ns;
  conclusion.outputs.emplace_back(std::move(life));
  if (asset && latest != latest_.end()) {
    PstRequest request = next_test(*asset, latest->second);
    request.header = concluded_from(event.header, "pst_request", kProducer, {event.header.message_id});
    request.header.pst_id.clear();
    conclusion.outputs.emplace_back(std::move(request));
  }
  return conclusion;
}

}  // namespace sealwatch::prognostic_assessment

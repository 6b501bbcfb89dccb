// What a replacement of the seal or the actuator does to the prognosis.
#include <algorithm>
#include <utility>

#include "sealwatch/message/provenance.hpp"
#include "services/common/text/words.hpp"
#include "services/prognostic_assessment/prognostic_assessment.hpp"
#include "services/prognostic_assessment/pst_request.hpp"

namespace sealwatch::prognostic_assessment {

/// The first report after a replacement names it, by an id that ends in its time: so it is known even where this
/// service's journal was lost, as nobody sends a maintenance_event again. So does the answer to it.
void PrognosticAssessment::learn_replacements(const std::string& asset_id, const Header& header) {
  for (const std::string& source : header.source_ids)
    if (const auto time = time_of_replacement(source)) history_[asset_id].add_replacement({source, *time});
}

/// Of several replacements the latest counts, whichever was reported last.
Conclusion PrognosticAssessment::replaced(const MaintenanceEvent& event) {
  Conclusion conclusion;
  accepted_[event.asset_id].take(event, conclusion);
  conclusion.consumed.push_back(event.header.message_id);
  if (!event.header.event_time_known) return conclusion;  // without its time it cannot part the history
  if (!history_[event.asset_id].holds(event.header.message_id)) return conclusion;
  const UtcTime time{event.header.event_time_ns};
  const std::string what = text::in_words(event.kind) + " on " + format_date(time);
  AssetHistory& history = history_[event.asset_id];
  history.add_replacement({event.header.message_id, time});
  const Replacement latest_replacement = *history.last_replacement();
  const UtcTime last = latest_replacement.time;
  const AssetConfig* asset = configuration_.find_asset(event.asset_id);
  RemainingLife life;
  UtcTime as_of = last;
  const auto latest = latest_.find(event.asset_id);
  const bool tested_since = latest != latest_.end() && latest->second.header.event_time_ns > last.nanoseconds;
  if (tested_since) {
    // Reported late, or with a wrong date: what has been tested since is judged by itself.
    LeakageEstimate since = latest->second;
    life = remaining_life(since);
    as_of = {since.header.event_time_ns};
    for (Forecast& forecast : life.forecasts) forecast.explanation += "; " + what + ", reported after this test";
  } else {
    if (asset && asset->condition) life.threshold = asset->condition->threshold;
    life.forecasts = no_forecast(time == last ? what + ": the history starts anew"
                                              : "replaced on " + format_date(last) + ": the history starts anew; " +
                                                    what + ", reported after it, changes nothing");
  }
  life.asset_id = event.asset_id;
  life.header = concluded_from(event.header, "remaining_life", kProducer, {event.header.message_id});
  life.header.pst_id.clear();
  life.header.event_time_ns = as_of.nanoseconds;
  tell_of(latest_replacement, life);
  conclusion.outputs.emplace_back(std::move(life));
  if (asset && !tested_since && time == last) {
    PstRequest request = first_test(*asset, time, what);
    request.header = concluded_from(event.header, "pst_request", kProducer, {event.header.message_id});
    request.header.pst_id.clear();
    conclusion.outputs.emplace_back(std::move(request));
  }
  return conclusion;
}

}  // namespace sealwatch::prognostic_assessment

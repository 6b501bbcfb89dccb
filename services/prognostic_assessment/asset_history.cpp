#include "services/prognostic_assessment/asset_history.hpp"

#include <algorithm>
#include <iterator>

namespace sealwatch::prognostic_assessment {
namespace {

bool waits_for_confirmation(const LeakageEstimate& estimate) {
  return estimate.reasons.size() == 1 && estimate.reasons.front().rfind(kUnconfirmed, 0) == 0;
}

}  // namespace

void AssetHistory::add(const LeakageEstimate& estimate) {
  concluded_.push_back(estimate.header.message_id);
  if (!estimate.header.event_time_known) return;
  HistoryEntry entry{.estimate_id = estimate.header.message_id,
                     .sample = {.time = {estimate.header.event_time_ns},
                                .condition = estimate.condition,
                                .condition_std = estimate.condition_std},
                     .eligible = estimate.used_for_forecast || waits_for_confirmation(estimate)};
  entry.pst_id = estimate.header.pst_id;
  retracted_.know(entry.pst_id, entry.sample.time);
  const auto place = std::upper_bound(entries_.begin(), entries_.end(), entry, [](const auto& a, const auto& b) {
    return std::tie(a.sample.time, a.estimate_id) < std::tie(b.sample.time, b.estimate_id);
  });
  entries_.insert(place, std::move(entry));
}

void AssetHistory::add_replacement(UtcTime time) {
  if (!withdrawn_.contains(time)) replacements_.insert(time);
}

void AssetHistory::apply(const Retraction& retraction) {
  retracted_.apply(retraction);
  if (const auto time = time_of_replacement(retraction.withdrawn_id)) {
    replacements_.erase(*time);
    withdrawn_.insert(*time);
  }
}

bool AssetHistory::has_estimate(const std::string& estimate_id) const {
  return std::find(concluded_.begin(), concluded_.end(), estimate_id) != concluded_.end();
}

std::optional<UtcTime> AssetHistory::last_replacement() const {
  return replacements_.empty() ? std::nullopt : std::optional(*replacements_.rbegin());
}

std::optional<UtcTime> AssetHistory::replaced_before(UtcTime now) const {
  const auto later = replacements_.upper_bound(now);
  return later == replacements_.begin() ? std::nullopt : std::optional(*std::prev(later));
}

std::vector<HistoryEntry> AssetHistory::until(UtcTime now) const {
  const std::optional<UtcTime> replaced = replaced_before(now);
  std::vector<HistoryEntry> entries;
  for (const HistoryEntry& entry : entries_)
    if (retracted_.counts(entry.pst_id) && entry.sample.time <= now && (!replaced || entry.sample.time > *replaced))
      entries.push_back(entry);
  return entries;
}

bool AssetHistory::has_later_than(UtcTime time) const {
  const HistoryEntry* last = last_counted();
  return last != nullptr && last->sample.time > time;
}

const HistoryEntry* AssetHistory::last_counted() const {
  const auto last = std::find_if(entries_.rbegin(), entries_.rend(),
                                 [this](const HistoryEntry& entry) { return retracted_.counts(entry.pst_id); });
  return last == entries_.rend() ? nullptr : &*last;
}

}  // namespace sealwatch::prognostic_assessment

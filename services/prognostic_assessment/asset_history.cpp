#include "services/prognostic_assessment/asset_history.hpp"

#include <algorithm>
#include <iterator>
#include <tuple>

namespace sealwatch::prognostic_assessment {
namespace {

bool waits_for_confirmation(const LeakageEstimate& estimate) {
  return estimate.reasons.size() == 1 && estimate.reasons.front().rfind(kUnconfirmed, 0) == 0;
}

bool in_order(const Replacement& a, const Replacement& b) { return std::tie(a.time, a.id) < std::tie(b.time, b.id); }

}  // namespace

void tell_of(const Replacement& replacement, RemainingLife& life) {
  life.replacement_known = true;
  life.replaced_ns = replacement.time.nanoseconds;
  if (std::ranges::find(life.header.source_ids, replacement.id) == life.header.source_ids.end())
    life.header.source_ids.push_back(replacement.id);
}

// Lives in journals of before told the time alone; the id was made of it.
Replacement replacement_of(const RemainingLife& life) {
  const UtcTime time{life.replaced_ns};
  for (const std::string& source : life.header.source_ids)
    if (time_of_replacement(source) == time) return {source, time};
  return {"maintenance_event/" + life.asset_id + "/" + format_utc(time), time};
}

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

void AssetHistory::add_replacement(const Replacement& replacement) {
  if (!holds(replacement.id)) return;
  const auto place = std::ranges::lower_bound(replacements_, replacement, in_order);
  if (place == replacements_.end() || place->id != replacement.id) replacements_.insert(place, replacement);
}

void AssetHistory::apply(const Retraction& retraction) {
  retracted_.apply(retraction);
  std::erase_if(replacements_, [&](const Replacement& one) { return one.id == retraction.withdrawn_id; });
}

bool AssetHistory::has_estimate(const std::string& estimate_id) const {
  return std::find(concluded_.begin(), concluded_.end(), estimate_id) != concluded_.end();
}

const Replacement* AssetHistory::last_replacement() const {
  return replacements_.empty() ? nullptr : &replacements_.back();
}

const Replacement* AssetHistory::replaced_before(UtcTime now) const {
  const auto later = std::ranges::upper_bound(replacements_, now, {}, &Replacement::time);
  return later == replacements_.begin() ? nullptr : &*std::prev(later);
}

std::vector<HistoryEntry> AssetHistory::until(UtcTime now) const {
  const Replacement* const replaced = replaced_before(now);
  std::vector<HistoryEntry> entries;
  for (const HistoryEntry& entry : entries_)
    if (retracted_.counts(entry.pst_id) && entry.sample.time <= now &&
        (replaced == nullptr || entry.sample.time > replaced->time))
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

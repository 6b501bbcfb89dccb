// The runner's part in how much people may say. Without DDS Security anybody can say well-formed acts under any name, as
// often as he likes; each would stand in the journal and in the audit trail for ever.
//
//   acts that count     of an asset and kind, so many a day (daily_acts.hpp); more are refused, with the alarm of a flood.
//                       Acknowledgements of the advice that stands are a sort of their own, and those of an alarm that
//                       nobody has acknowledged are bounded by the alarms: invented ones keep no real one out
//   acts that wait      for a second person, or for what they mean to be known: so many of an asset at a time, for so long.
//                       What has waited too long is forgotten, and counts as another when it is said again
//
// What one service takes, all take, by its record (layer_runner_records.cpp), whatever the others have counted by then.
#include <algorithm>
#include <ranges>
#include <utility>

#include "sealwatch/core/visible_text.hpp"
#include "services/common/runtime/layer_runner.hpp"
#include "services/common/runtime/log.hpp"
#include "services/common/runtime/operator_acts.hpp"

namespace sealwatch {
namespace {

constexpr const char* kFlood = "flood";
constexpr std::chrono::seconds kFloodIsOver{60};
/// A neighbour that took a confirmation in the last moment tells of it within so long.
constexpr std::chrono::minutes kTellsOfIt{1};

std::chrono::nanoseconds steady_now() { return std::chrono::steady_clock::now().time_since_epoch(); }

/// By the wall clock; what that one, set back, calls the future is now.
std::chrono::nanoseconds age(const OperatorAct& act, UtcTime now) {
  return std::chrono::nanoseconds(std::max<std::int64_t>(now.nanoseconds - act.at.nanoseconds, 0));
}

/// With which others an act counts. `is_of_other_advice`: an acknowledgement, of other advice than what stands.
std::string sort_of(const OperatorAct& act, bool is_of_other_advice) {
  return act.kind + " of " + (act.asset_id.empty() ? "no asset" : "asset " + act.asset_id) +
         (is_of_other_advice ? ", of other advice than what stands" : "");
}

}  // namespace

/// Retractions of nothing known are few for ever, or wait (admission.hpp).
std::optional<std::string> LayerRunner::counted_as(const Message& act) const {
  const auto told = act_of(act, {}, {});
  if (!told || !is_listened_to(act)) return std::nullopt;
  if (const auto retraction = retraction_of(told->asset_id, told->subject))
    if (admission_.means_nothing(told->asset_id, *retraction)) return std::nullopt;
  const auto* const seen = std::get_if<Acknowledgement>(&act);
  if (seen == nullptr) return sort_of(*told, false);
  const AlarmEntry* const alarm = desk_ ? desk_->entry_of(seen->asset_id, seen->advisory_id) : nullptr;
  if (alarm != nullptr && alarm->acknowledged_by.empty()) return std::nullopt;
  return sort_of(*told, is_of_later_advice(act));
}

std::optional<std::string> LayerRunner::refusal_of_many(const Message& message) const {
  const auto sort = counted_as(message);
  const auto taken = sort ? taken_acts_.find(*sort) : taken_acts_.end();
  if (taken == taken_acts_.end() || !taken->second.is_full(std::chrono::steady_clock::now())) return std::nullopt;
  return std::to_string(DailyActs::kMostInFull) + " acts were taken within a day already: " + *sort +
         "; find out who sends them, and say it again tomorrow";
}

void LayerRunner::count_act(const Message& act) {
  if (const auto sort = counted_as(act)) taken_acts_[*sort].admits(std::chrono::steady_clock::now());
}

/// Of an act that was taken, or waits, later entries tell what became of it.
void LayerRunner::restore_counts(const std::vector<AuditEntry>& acts) {
  std::set<std::pair<std::string, std::string>> known;  // asset, id
  for (const AuditEntry& entry : acts) {
    const OperatorAct& act = entry.act;
    if (act.kind == kRefusedActs || !is_said_here(act.outcome)) continue;
    const bool is_in = is_taken(act.outcome) || act.outcome == kWaits || act.outcome == kAhead;
    const std::pair key(act.asset_id, act.subject);
    const bool is_first = is_in ? known.insert(key).second : !known.contains(key);
    if (!is_first || age(act, clock_.now()) >= DailyActs::kDay) continue;
    if (is_in)
      acts_of_last_day_[act.asset_id].push_back(act);
    else
      (void)refused_acts_.admits(std::chrono::steady_clock::now() - age(act, clock_.now()));
  }
}

void LayerRunner::count_past_acts(const std::string& asset_id) {
  const auto past = acts_of_last_day_.extract(asset_id);
  if (!past) return;
  const auto stands = standing_.find(asset_id);
  const std::string of_standing = "acknowledgement/" + (stands == standing_.end() ? "" : stands->second) + "/";
  for (const OperatorAct& act : past.mapped()) {
    if (is_retraction_id(act.subject) && !admission_.meant_something(asset_id, act.subject)) continue;
    const bool is_seen = act.kind == name_of(Topic::acknowledgement);
    const std::string sort = sort_of(act, is_seen && !act.subject.starts_with(of_standing));
    (void)taken_acts_[sort].admits(std::chrono::steady_clock::now() - age(act, clock_.now()));
  }
}

void LayerRunner::tell_of_many(const Message& act, const std::string& refused) {
  if (!refusal_of_many(act)) return;
  const bool is_new = alarms_.raise({.kind = kFlood,
                                     .asset_id = asset_of(act),
                                     .subject = act_of(act, {}, {})->kind,
                                     .pst_id = {},
                                     .text = refused,
                                     .since_ns = clock_.now().nanoseconds},
                                    steady_now() + kFloodIsOver);
  if (is_new) log_event(LogLevel::warn, "flood", {{"asset", asset_of(act)}, {"error", refused}});
}

/// While the clock may be wrong, time goes on as it did before it was set.
bool LayerRunner::has_waited_too_long(UtcTime since) const {
  const auto waited_ns = believed_time().nanoseconds - since.nanoseconds;
  return waited_ns >= std::chrono::nanoseconds(options_.longest_wait_of_act).count();
}

/// When an act was said that is ahead, by a neighbour's record of it or, where there is none, now.
UtcTime LayerRunner::time_said(const ActRecord* record) const {
  const bool is_known = record != nullptr && record->header.publishing_time_ns != 0;
  return is_known ? UtcTime{record->header.publishing_time_ns} : clock_.now();
}

void LayerRunner::note_taken_elsewhere(const ActRecord& record, const Message& act) {
  if (record.is_ahead || said_ahead_.erase(header_of(act).message_id) == 0) return;
  (void)note_act(act, {}, InputState::ahead, &record);
}

/// Nobody is asked while more may come about its asset: a confirmation that a neighbour took, or what an act means.
Status LayerRunner::end_waits() {
  const std::string hour =
      std::to_string(std::chrono::ceil<std::chrono::minutes>(options_.longest_wait_of_act).count());
  const auto is_over = [this](const std::string& asset_id, UtcTime since) {
    return has_waited_too_long(add_seconds(since, std::chrono::duration<double>(kTellsOfIt).count())) &&
           is_quiet(asset_id);
  };
  for (auto one = awaiting_.begin(); one != awaiting_.end();) {
    const Message& act = *one->second.act;
    const bool ends = is_over(asset_of(act), one->second.since);
    if (ends) give_up(act, "nobody else confirmed it within " + hour + " minutes; have it said again");
    one = ends ? awaiting_.erase(one) : std::next(one);
  }
  for (auto one = said_ahead_.begin(); one != said_ahead_.end();) {
    const auto& [act_id, said] = *one;
    const bool ends = is_over(said.asset_id, said.since);
    if (ends) {
      auto act = journal_.input(act_id);
      if (!act) return fail(act.error());
      if (*act) give_up(**act, "what it means did not come within " + hour + " minutes; say it again once it is there");
      if (--acts_ahead_[said.asset_id] == 0) acts_ahead_.erase(said.asset_id);
    }
    one = ends ? said_ahead_.erase(one) : std::next(one);
  }
  return given_up_.empty() ? Status() : in_batch([this] { return record_acts(); }, Survives::power_cuts);
}

void LayerRunner::give_up(const Message& act, const std::string& why) {
  const std::string act_id = header_of(act).message_id;
  alarms_.clear("awaits_confirmation", asset_of(act), act_id);
  given_up_.push_back(act_id);
  if (auto ended = act_of(act, clock_.now(), why)) acts_.push_back(std::move(*ended));
  note_error(asset_of(act) + ": " + act_id + ": " + why);
}

}  // namespace sealwatch

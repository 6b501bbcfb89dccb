#include "services/common/runtime/alarm_desk.hpp"

#include <algorithm>
#include <array>

#include "sealwatch/message/ne107.hpp"

namespace sealwatch {
namespace {

constexpr const char* kNoHeartbeat = "no_heartbeat";
constexpr std::int64_t kLongestShelf_ns = 366LL * 86'400'000'000'000;
/// Of a text or name in somebody's heartbeat; a longer one no service of ours says.
constexpr std::size_t kLongestName = 500;
constexpr std::size_t kLongestText = 4000;

/// By design: while the cause is active, the effect is what one must expect of it, and nobody need act on it.
struct Causes {
  std::string_view effect;         ///< kind
  std::string_view cause;          ///< kind
  std::string_view cause_subject;  ///< "" any
  bool of_the_same_asset;
};
constexpr std::array kSuppressedBy = {
    // A test on its way to state detection is not known to have been made.
    Causes{kOverdueAlarm, kNoHeartbeat, "data_acquisition", false},
    Causes{kOverdueAlarm, kNoHeartbeat, "data_manipulation", false},
    Causes{kOverdueAlarm, kNoHeartbeat, "state_detection", false},
    Causes{kOverdueAlarm, "set_aside", "", true},
    // Set forward, the clock passes dates that nobody has missed.
    Causes{kOverdueAlarm, "clock_step", "", false},
};

/// Alarms that only an act of somebody ends: who does it has seen them.
constexpr std::array kEndedByAct = {std::string_view("set_aside"), std::string_view("awaits_confirmation"),
                                    kOutOfServiceAlarm};

bool is_ended_by_act(const std::string& kind) { return std::ranges::find(kEndedByAct, kind) != kEndedByAct.end(); }

std::tuple<std::string, std::string, std::string> key_of(const ServiceAlarm& alarm) {
  return {alarm.kind, alarm.asset_id, alarm.subject};
}

bool is_named(const ServiceAlarm& alarm, const std::string& asset_id, const std::string& id) {
  return alarm.asset_id == asset_id && alarm_id(alarm) == id;
}

bool is_of_ours(const ServiceAlarm& alarm) {
  return !alarm.kind.empty() && alarm.kind.size() <= 64 && alarm.asset_id.size() <= kLongestName &&
         alarm.subject.size() <= kLongestName && alarm.text.size() <= kLongestText;
}

/// An advisory asks for it earlier, or with a date where there was none, or with none, which is as soon as may be.
bool is_more_pressing(std::int64_t before_ns, std::int64_t now_ns) {
  if ((before_ns == 0) != (now_ns == 0)) return true;
  return now_ns < before_ns;
}

Acknowledgement alarm_over(const ServiceAlarm& alarm, UtcTime at) {
  Acknowledgement over;
  over.asset_id = alarm.asset_id;
  over.advisory_id = alarm_id(alarm);
  over.remark = "the alarm is over";
  over.header.message_id = alarm_over_id(over.advisory_id, at);
  over.header.event_time_known = true;
  over.header.event_time_ns = at.nanoseconds;
  return over;
}

void take_off_shelf(AlarmEntry& entry) {
  entry.shelved_by.clear();
  entry.shelved_reason.clear();
  entry.shelved_until_ns = 0;
}

/// What is to be seen first.
int rank(const AlarmEntry& entry, UtcTime time) {
  const AlarmState state = state_of(entry, time);
  const bool stands_in_advisory = state == AlarmState::unacknowledged || state == AlarmState::acknowledged;
  if (is_advice(entry.alarm) && stands_in_advisory) return 6;
  switch (state) {
    case AlarmState::unacknowledged:
      return 0;
    case AlarmState::returned:
      return 1;
    case AlarmState::acknowledged:
      return 2;
    case AlarmState::shelved:
      return 3;
    case AlarmState::suppressed:
      return 4;
    case AlarmState::out_of_service:
      return 5;
  }
  return 6;
}

}  // namespace

AlarmDesk::AlarmDesk(Options options, std::vector<AlarmEntry> kept, Steady now, UtcTime time)
    : options_(std::move(options)) {
  for (const std::string& service : options_.services) heard_[service] = now;
  for (AlarmEntry& one : kept) {
    const Key key = key_of(one.alarm);
    entries_[key] = {.kept = std::move(one), .told_by = {}};
  }
  std::vector<Key> ended;
  for (auto& [key, entry] : entries_) {
    if (entry.kept.ended_ns != 0) continue;
    const bool is_expected = heard_.contains(entry.kept.service) || entry.kept.service == options_.service;
    if (is_expected)
      entry.told_by[entry.kept.service] = now;
    else
      ended.push_back(key);
  }
  for (const Key& key : ended) end(key, time);
}

AlarmDesk::Entry& AlarmDesk::raise(const std::string& service, const ServiceAlarm& alarm, Steady now) {
  const Key key = key_of(alarm);
  const auto [found, is_new] = entries_.try_emplace(key);
  Entry& entry = found->second;
  if (is_new || entry.kept.ended_ns != 0) {  // it may come again: then it is another occurrence, on the same shelf
    entry.kept.service = service;
    entry.kept.alarm = alarm;
    entry.kept.alarm.ne107.clear();  // told anew, by its kind
    entry.kept.ended_ns = 0;
    entry.kept.acknowledged_by.clear();
    entry.kept.acknowledged_at_ns = 0;
    touched_.insert(key);
  }
  entry.told_by[service] = now;
  return entry;
}

void AlarmDesk::forget(const Key& key) {
  entries_.erase(key);
  touched_.insert(key);
}

/// What was acknowledged, and was over when it was, or is now.
void AlarmDesk::note_over(const AlarmEntry& kept, UtcTime time) {
  if (kept.acknowledged_by.empty() || is_advice(kept.alarm)) return;
  over_.push_back(alarm_over(kept.alarm, {std::max(time.nanoseconds, kept.acknowledged_at_ns)}));
}

void AlarmDesk::end(const Key& key, UtcTime time) {
  Entry& entry = entries_.at(key);
  entry.told_by.clear();
  touched_.insert(key);
  note_over(entry.kept, time);
  const bool is_seen = !entry.kept.acknowledged_by.empty() || is_ended_by_act(entry.kept.alarm.kind);
  if (is_seen && entry.kept.shelved_until_ns <= time.nanoseconds) return forget(key);
  entry.kept.ended_ns = time.nanoseconds;
  drop_oldest_returned(entry.kept.alarm.kind);
}

void AlarmDesk::drop_oldest_returned(const std::string& kind) {
  std::size_t returned = 0;
  const Entries::value_type* oldest = nullptr;
  for (const auto& one : entries_) {
    if (std::get<0>(one.first) != kind || one.second.kept.ended_ns == 0) continue;
    ++returned;
    if (oldest == nullptr || one.second.kept.ended_ns < oldest->second.kept.ended_ns) oldest = &one;
  }
  if (returned > kMostOfAKind) forget(Key(oldest->first));
}

std::size_t AlarmDesk::active_of(const std::string& kind) const {
  return static_cast<std::size_t>(std::ranges::count_if(
      entries_, [&](const auto& one) { return std::get<0>(one.first) == kind && one.second.kept.ended_ns == 0; }));
}

void AlarmDesk::hear(const ServiceStatus& status, Steady now, UtcTime time) {
  const bool is_expected = heard_.contains(status.service);
  if (!is_expected && status.service != options_.service) return;
  if (is_expected) {
    heard_[status.service] = now;
    heard_ever_.insert(status.service);
    const Key silent{kNoHeartbeat, "", status.service};
    if (const auto found = entries_.find(silent); found != entries_.end() && found->second.kept.ended_ns == 0)
      end(silent, time);
  }
  for (const ServiceAlarm& alarm : status.alarms) {
    const bool has_room = entries_.contains(key_of(alarm)) || active_of(alarm.kind) < kMostOfAKind;
    if (is_of_ours(alarm) && !is_advice(alarm) && alarm.kind != kOutOfServiceAlarm && has_room)
      (void)raise(status.service, alarm, now);
  }
  // What a service has not recalled yet it does not deny.
  if (status.alarm_count > status.alarms.size() || status.state == kRestoring) return;
  told_all_.insert(status.service);
  end_untold(status, now, time);
}

bool AlarmDesk::has_heard_all() const {
  return std::ranges::all_of(options_.services, [this](const std::string& one) { return told_all_.contains(one); });
}

void AlarmDesk::end_untold(const ServiceStatus& status, Steady now, UtcTime time) {
  std::vector<Key> over;
  for (auto& [key, entry] : entries_) {
    const auto told = entry.told_by.find(status.service);
    if (told == entry.told_by.end() || now - told->second <= options_.off_delay) continue;
    if (is_advice(entry.kept.alarm) || entry.kept.alarm.kind == kNoHeartbeat ||
        entry.kept.alarm.kind == kOutOfServiceAlarm)
      continue;  // of the desk's own knowledge
    entry.told_by.erase(told);
    if (entry.told_by.empty()) over.push_back(key);
  }
  for (const Key& key : over) end(key, time);
}

void AlarmDesk::stand(const StandingAdvice& said, UtcTime time) {
  std::vector<Key> over;
  for (const auto& [key, entry] : entries_)
    if (is_advice(entry.kept.alarm) && entry.kept.alarm.asset_id == said.asset_id && entry.kept.ended_ns == 0 &&
        (!said.advice || key != key_of(said.advice->alarm)))
      over.push_back(key);
  // What takes its place, or what somebody did, is the answer to it; else it has returned to normal.
  for (const Key& key : over) said.advice || said.is_answered ? forget(key) : end(key, time);
  if (!said.advice) return;
  const bool is_known = entries_.contains(key_of(said.advice->alarm));
  AlarmEntry& entry = raise(options_.service, said.advice->alarm, {}).kept;
  const AlarmEntry before = entry;
  if (is_known && is_more_pressing(entry.due_ns, said.advice->due_ns)) take_off_shelf(entry);
  entry.alarm.text = said.advice->alarm.text;
  entry.due_ns = said.advice->due_ns;
  entry.acknowledged_by = said.advice->acknowledged_by;
  entry.acknowledged_at_ns = said.advice->acknowledged_at_ns;
  if (!(entry == before)) touched_.insert(key_of(entry.alarm));
}

void AlarmDesk::look(Steady now, UtcTime time) {
  for (const auto& [service, last] : heard_) {
    const Key key{kNoHeartbeat, "", service};
    const auto found = entries_.find(key);
    const bool stands = found != entries_.end() && found->second.kept.ended_ns == 0;
    if (stands || service == options_.service || now - last <= options_.silence) continue;
    const bool is_silent_since_before = !heard_ever_.contains(service);
    (void)raise(options_.service,
                {.kind = kNoHeartbeat,
                 .asset_id = {},
                 .subject = service,
                 .pst_id = {},
                 .text = is_silent_since_before ? "no heartbeat since before " + format_utc(time) : "no heartbeat",
                 .since_ns = is_silent_since_before ? 0 : time.nanoseconds},
                now);
  }
  end_shelves(time);
}

void AlarmDesk::end_shelves(UtcTime time) {
  std::vector<Key> seen;
  for (auto& [key, entry] : entries_) {
    AlarmEntry& kept = entry.kept;
    if (kept.shelved_until_ns == 0 || kept.shelved_until_ns > time.nanoseconds) continue;
    take_off_shelf(kept);
    touched_.insert(key);
    if (kept.ended_ns != 0 && (!kept.acknowledged_by.empty() || is_ended_by_act(kept.alarm.kind))) seen.push_back(key);
  }
  for (const Key& key : seen) forget(key);
}

AlarmDesk::Entries::iterator AlarmDesk::find(const std::string& asset_id, const std::string& id) {
  return std::ranges::find_if(entries_, [&](const auto& one) { return is_named(one.second.kept.alarm, asset_id, id); });
}

const AlarmEntry* AlarmDesk::entry_of(const std::string& asset_id, const std::string& id) const {
  const auto found =
      std::ranges::find_if(entries_, [&](const auto& one) { return is_named(one.second.kept.alarm, asset_id, id); });
  return found == entries_.end() ? nullptr : &found->second.kept;
}

bool AlarmDesk::takes(const Acknowledgement& seen) const {
  return std::ranges::any_of(entries_, [&](const auto& one) {
    const AlarmEntry& kept = one.second.kept;
    const bool is_here = !is_advice(kept.alarm) || kept.ended_ns != 0;
    return is_here && kept.alarm.asset_id == seen.asset_id && alarm_id(kept.alarm) == seen.advisory_id;
  });
}

void AlarmDesk::acknowledge(const Acknowledgement& seen, UtcTime time) {
  const auto found = find(seen.asset_id, seen.advisory_id);
  if (found == entries_.end()) return;
  const Key key = found->first;
  AlarmEntry& kept = found->second.kept;
  kept.acknowledged_by = seen.acknowledged_by;
  kept.acknowledged_at_ns = seen.header.event_time_known ? seen.header.event_time_ns : time.nanoseconds;
  touched_.insert(key);
  if (kept.ended_ns == 0) return;
  note_over(kept, time);
  if (kept.shelved_until_ns <= time.nanoseconds) forget(key);
}

void AlarmDesk::take_back(const Acknowledgement& over) {
  const auto found = find(over.asset_id, over.advisory_id);
  if (found == entries_.end() || found->second.kept.acknowledged_at_ns > over.header.event_time_ns) return;
  AlarmEntry& kept = found->second.kept;
  if (kept.acknowledged_by.empty() || kept.ended_ns != 0) return;
  kept.acknowledged_by.clear();
  kept.acknowledged_at_ns = 0;
  touched_.insert(found->first);
}

std::optional<std::string> AlarmDesk::apply(const MaintenanceEvent& event, UtcTime time) {
  const auto act = alarm_act_of(event);
  if (!act) return "its message_id, '" + event.header.message_id + "', does not say which alarm is meant";
  if (!act->alarm_id.empty()) return shelve(event, *act, time);
  if (event.asset_id.empty()) return "it names no asset";
  const ServiceAlarm alarm{.kind = std::string(kOutOfServiceAlarm),
                           .asset_id = event.asset_id,
                           .subject = {},
                           .pst_id = {},
                           .text = event.remark,
                           .since_ns = event.header.event_time_ns};
  const Key key = key_of(alarm);
  const bool is_out = entries_.contains(key);
  if (event.kind == kAssetInService) {
    if (!is_out) return event.asset_id + " is not out of service";
    forget(key);
    return std::nullopt;
  }
  if (is_out) return event.asset_id + " is out of service already, by " + entries_.at(key).kept.out_of_service_by;
  raise(options_.service, alarm, {}).kept.out_of_service_by = event.reported_by;
  return std::nullopt;
}

std::optional<std::string> AlarmDesk::shelve(const MaintenanceEvent& event, const AlarmAct& act, UtcTime time) {
  const auto found = find(event.asset_id, act.alarm_id);
  if (found == entries_.end())
    return "there is no alarm '" + act.alarm_id + "' " +
           (event.asset_id.empty() ? "without an asset" : "of " + event.asset_id);
  AlarmEntry& kept = found->second.kept;
  if (event.kind == kAlarmUnshelved) {
    if (kept.shelved_until_ns <= time.nanoseconds) return "'" + act.alarm_id + "' is not shelved";
    kept.shelved_until_ns = time.nanoseconds;  // its end has come
    end_shelves(time);
    return std::nullopt;
  }
  if (act.until->nanoseconds <= time.nanoseconds) return "its end, " + format_utc(*act.until) + ", is past";
  if (act.until->nanoseconds > time.nanoseconds + kLongestShelf_ns)
    return "its end, " + format_utc(*act.until) + ", lies more than a year ahead";
  kept.shelved_by = event.reported_by;
  kept.shelved_reason = event.remark;
  kept.shelved_until_ns = act.until->nanoseconds;
  touched_.insert(found->first);
  return std::nullopt;
}

std::string AlarmDesk::out_of_service_by(const std::string& asset_id) const {
  const auto found = asset_id.empty() ? entries_.end() : entries_.find(Key{kOutOfServiceAlarm, asset_id, ""});
  return found == entries_.end() ? std::string() : found->second.kept.out_of_service_by;
}

/// The active alarm that it follows from; one that is itself out of sight hides nothing else.
std::string AlarmDesk::cause_of(const ServiceAlarm& alarm, UtcTime time) const {
  for (const Causes& row : kSuppressedBy) {
    if (row.effect != alarm.kind) continue;
    for (const auto& [key, entry] : entries_) {
      const ServiceAlarm& cause = entry.kept.alarm;
      const bool is_meant = cause.kind == row.cause &&
                            (row.cause_subject.empty() || cause.subject == row.cause_subject) &&
                            (!row.of_the_same_asset || cause.asset_id == alarm.asset_id);
      const bool is_in_sight = entry.kept.ended_ns == 0 && entry.kept.shelved_until_ns <= time.nanoseconds &&
                               out_of_service_by(cause.asset_id).empty();
      if (is_meant && is_in_sight) return alarm_id(cause);
    }
  }
  return {};
}

AlarmEntry AlarmDesk::as_told(const AlarmEntry& kept, UtcTime time) const {
  AlarmEntry told = kept;
  told.alarm.ne107 = words(category_of(kept.alarm.kind));
  told.out_of_service_by = out_of_service_by(kept.alarm.asset_id);
  if (kept.ended_ns == 0) told.suppressed_by = cause_of(kept.alarm, time);
  return told;
}

void AlarmDesk::tell(ServiceStatus& status, UtcTime time) const {
  status.desk.clear();
  for (const auto& [key, entry] : entries_) status.desk.push_back(as_told(entry.kept, time));
  std::ranges::stable_sort(status.desk, [&](const AlarmEntry& a, const AlarmEntry& b) {
    const int first = rank(a, time);
    const int second = rank(b, time);
    return first != second ? first < second : a.alarm.since_ns > b.alarm.since_ns;
  });
  status.desk_count = status.desk.size();
  if (status.desk.size() > kMostTold) status.desk.resize(kMostTold);
}

AlarmDesk::Changes AlarmDesk::take_changes() {
  Changes changes;
  for (const Key& key : std::exchange(touched_, {})) {
    const auto found = entries_.find(key);
    if (found != entries_.end())
      changes.kept.push_back(found->second.kept);
    else
      changes.forgotten.push_back({.kind = std::get<0>(key),
                                   .asset_id = std::get<1>(key),
                                   .subject = std::get<2>(key),
                                   .pst_id = {},
                                   .text = {},
                                   .since_ns = 0});
  }
  return changes;
}

}  // namespace sealwatch

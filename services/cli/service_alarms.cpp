#include "services/cli/service_alarms.hpp"

#include <algorithm>
#include <array>
#include <set>

#include "sealwatch/core/time.hpp"
#include "sealwatch/core/visible_text.hpp"
#include "sealwatch/message/alarm_state.hpp"
#include "services/cli/terminal.hpp"

namespace sealwatch::cli {
namespace {

constexpr std::string_view kNoHeartbeat = "no_heartbeat";

struct Row {
  std::string_view kind;
  std::string_view meaning;
};
constexpr std::array kMeanings = {
    Row{kNoHeartbeat, "is not heard"},
    Row{"set_aside", "set aside after two failures"},
    Row{"rival", "not alone"},
    Row{"clock_step", "clock was set"},
    Row{"clock_unsynchronised", "clock is not synchronised"},
    Row{"future_test", "live tests change no advice"},
    Row{"refused_test", "a test was refused"},
    Row{"refused_conclusion", "what another service concluded was refused"},
    Row{"recording_not_taken", "a recording was not taken"},
    Row{"sensor_lost", "sensor lost"},
    Row{"awaits_confirmation", "an act waits for a second person"},
    Row{"unpublished_model", "an accepted model does not count"},
    Row{"unknown_writer", "messages from an unknown writer"},
    Row{"flood", "messages dropped"},
    Row{"missing_blocks", "samples do not come"},
    Row{"unknown_asset", "messages about assets that are not configured"},
    Row{"refused_right", "connection refused"},
    Row{kAdviceAlarm, "advice"},
    Row{kOverdueAlarm, "a test is overdue"},
    Row{kOutOfServiceAlarm, "work in progress"},
};
static_assert(kMeanings.size() == kNe107.size());

const Row* row_of(std::string_view kind) {
  const auto found = std::ranges::find(kMeanings, kind, &Row::kind);
  return found == kMeanings.end() ? nullptr : &*found;
}

bool is_same(const ServiceAlarm& a, const ServiceAlarm& b) {
  return a.kind == b.kind && a.asset_id == b.asset_id && a.subject == b.subject;
}

std::string begin_of(const HeardAlarm& heard, UtcTime now) {
  if (!heard.entry) return "ALARM";
  const AlarmEntry& entry = *heard.entry;
  switch (state_of(entry, now)) {
    case AlarmState::unacknowledged:
      return "ALARM";
    case AlarmState::acknowledged:
      return "ALARM, acknowledged by " + entry.acknowledged_by;
    case AlarmState::returned:
      return "ENDED " + to_the_second({entry.ended_ns}) + ", not acknowledged";
    case AlarmState::shelved:
      return "SHELVED until " + to_the_second({entry.shelved_until_ns}) + " by " + entry.shelved_by + ", " +
             entry.shelved_reason;
    case AlarmState::suppressed:
      return "SUPPRESSED by " + entry.suppressed_by;
    case AlarmState::out_of_service:
      return "OUT OF SERVICE by " + entry.out_of_service_by;
  }
  return {};
}

/// What somebody can do about it, to be pasted.
std::string command_for(const HeardAlarm& heard, UtcTime now) {
  const ServiceAlarm& alarm = heard.alarm;
  const std::string asset = alarm.asset_id.empty() ? "-" : shell_word(alarm.asset_id);
  if (alarm.kind == "set_aside") return "sealwatch quarantine retry " + alarm.subject + " --by NAME";
  if (alarm.kind == "awaits_confirmation")
    return "sealwatch confirm " + asset + " " + shell_word(alarm.subject) + " --by NAME";
  if (alarm.kind == kOutOfServiceAlarm) return "sealwatch in-service " + asset + " --by NAME";
  const bool is_unseen = heard.entry && state_of(*heard.entry, now) == AlarmState::returned;
  return is_unseen ? "sealwatch acknowledge " + asset + " " + shell_word(alarm_id(alarm)) + " --by NAME" : "";
}

}  // namespace

bool is_in_view(const HeardAlarm& heard, UtcTime now) {
  if (!heard.entry) return true;
  const AlarmState state = state_of(*heard.entry, now);
  return state == AlarmState::unacknowledged || state == AlarmState::acknowledged;
}

std::vector<HeardAlarm> alarms_of(const std::vector<ServicesHeard::Service>& services) {
  std::vector<AlarmEntry> entries;
  for (const ServicesHeard::Service& service : services)
    if (service.heard) entries.insert(entries.end(), service.last.desk.begin(), service.last.desk.end());
  const auto entry_of = [&](const ServiceAlarm& alarm) {
    return std::ranges::find_if(entries, [&](const AlarmEntry& entry) { return is_same(entry.alarm, alarm); });
  };
  std::vector<HeardAlarm> alarms;
  std::set<const AlarmEntry*> found;
  const auto add = [&](const std::string& service, const ServiceAlarm& alarm, const ServiceAlarm& as_kept) {
    const auto entry = entry_of(as_kept);
    alarms.push_back({service, alarm});
    if (entry == entries.end()) return;
    alarms.back().entry = *entry;
    found.insert(&*entry);
  };
  for (const ServicesHeard::Service& service : services) {
    if (!service.trouble.empty() && service.expected) {
      ServiceAlarm silent;
      silent.kind = kNoHeartbeat;
      silent.text = service.trouble;
      ServiceAlarm as_kept = silent;
      as_kept.subject = service.name;
      add(service.name, silent, as_kept);
    }
    if (!service.heard) continue;
    for (const ServiceAlarm& alarm : service.last.alarms) add(service.name, alarm, alarm);
    if (service.last.alarm_count > service.last.alarms.size())
      alarms.back().untold = service.last.alarm_count - service.last.alarms.size();
  }
  for (const AlarmEntry& entry : entries)
    if (!found.contains(&entry)) alarms.push_back({.service = entry.service, .alarm = entry.alarm, .entry = entry});
  return alarms;
}

bool is_blind(const std::vector<HeardAlarm>& alarms, UtcTime now) {
  return std::ranges::any_of(alarms, [&](const HeardAlarm& one) {
    return is_in_view(one, now) && category_of(one.alarm.kind) != Ne107::maintenance_required;
  });
}

bool stands_in_advisory(const HeardAlarm& heard, UtcTime now) {
  return is_advice(heard.alarm) && is_in_view(heard, now);
}

std::string lines_of(const HeardAlarm& heard, UtcTime now) {
  const ServiceAlarm& alarm = heard.alarm;
  const Row* const row = row_of(alarm.kind);
  std::string line = begin_of(heard, now) + " (" + std::string(words(category_of(alarm.kind))) + ")  " + heard.service;
  if (!alarm.asset_id.empty()) line += "  " + alarm.asset_id;
  line += "  " + std::string(row == nullptr ? std::string_view(alarm.kind) : row->meaning);
  if (alarm.since_ns != 0) line += " since " + to_the_second({alarm.since_ns});
  line += ": " + (alarm.subject.empty() ? "" : alarm.subject + ": ") + alarm.text;
  if (heard.untold > 0) line += "; and " + std::to_string(heard.untold) + " more: sealwatch quarantine list";
  const std::string command = command_for(heard, now);
  return wrapped(line, 120, 2) + "\n" + (command.empty() ? "" : "  (" + command + ")\n");
}

}  // namespace sealwatch::cli

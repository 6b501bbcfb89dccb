#include "services/common/runtime/recalled_alarm_acts.hpp"

#include <algorithm>

#include "sealwatch/message/alarm_acts.hpp"

namespace sealwatch {
namespace {

UtcTime time_said(const Message& act) {
  const auto* event = std::get_if<MaintenanceEvent>(&act);
  const auto in_id = event == nullptr ? std::nullopt : time_of_alarm_act(event->asset_id, event->header.message_id);
  return in_id.value_or(UtcTime{header_of(act).event_time_ns});
}

/// Done, or of no alarm that could come still.
bool is_decided(const Acknowledgement& seen, AlarmDesk& desk, UtcTime time, std::optional<std::string>& why_not) {
  const AlarmEntry* const entry = desk.entry_of(seen.asset_id, seen.advisory_id);
  if (entry == nullptr) {
    if (desk.has_heard_all()) why_not = "its alarm is over";
    return why_not.has_value();
  }
  if (seen.header.event_time_ns < entry->alarm.since_ns)
    why_not = "it was said of an earlier alarm, the one that stands began at " + format_utc({entry->alarm.since_ns});
  else if (!entry->acknowledged_by.empty())
    why_not = "it is acknowledged already, by " + entry->acknowledged_by;
  else
    desk.acknowledge(seen, time);
  return true;
}

}  // namespace

void RecalledAlarmActs::note_over(const std::string& asset_id, const std::string& act_id) {
  const auto over = alarm_over_of(act_id);
  if (!over) return;
  UtcTime& last = last_over_.try_emplace({asset_id, over->alarm_id}, over->at).first->second;
  last = std::max(last, over->at);
}

void RecalledAlarmActs::note_said(std::string_view kind, const std::string& asset_id, const std::string& act_id) {
  MaintenanceEvent event;
  event.asset_id = asset_id;
  event.kind = kind;
  event.header.message_id = act_id;
  const auto act = alarm_act_of(event);
  const auto time = time_of_alarm_act(asset_id, act_id);
  if (!act || !time) return;
  UtcTime& last = last_said_.try_emplace({asset_id, act->alarm_id}, *time).first->second;
  last = std::max(last, *time);
}

void RecalledAlarmActs::add(Message act) {
  if (const auto* event = std::get_if<MaintenanceEvent>(&act))
    note_said(event->kind, event->asset_id, event->header.message_id);
  if (const auto* seen = std::get_if<Acknowledgement>(&act); seen && seen->acknowledged_by.empty())
    note_over(seen->asset_id, seen->header.message_id);
  const auto place = std::ranges::upper_bound(waiting_, time_said(act), {}, time_said);
  waiting_.insert(place, std::move(act));
}

void RecalledAlarmActs::decide(AlarmDesk& desk, UtcTime time) {
  std::erase_if(waiting_, [&](Message& act) {
    std::optional<std::string> why_not;
    if (!is_decided(act, desk, time, why_not)) return false;
    decided_.push_back({std::move(act), std::move(why_not)});
    return true;
  });
}

bool RecalledAlarmActs::is_decided(const Message& act, AlarmDesk& desk, UtcTime time,
                                   std::optional<std::string>& why_not) const {
  if (const auto* seen = std::get_if<Acknowledgement>(&act)) return is_decided(*seen, desk, time, why_not);
  const auto* const event = std::get_if<MaintenanceEvent>(&act);
  return event == nullptr || is_decided(*event, desk, time, why_not);
}

bool RecalledAlarmActs::is_decided(const Acknowledgement& seen, AlarmDesk& desk, UtcTime time,
                                   std::optional<std::string>& why_not) const {
  if (seen.acknowledged_by.empty()) {  // the desk itself said it
    if (alarm_over_of(seen.header.message_id)) desk.take_back(seen);
    return true;
  }
  const auto over = last_over_.find({seen.asset_id, seen.advisory_id});
  if (over == last_over_.end() || seen.header.event_time_ns > over->second.nanoseconds)
    return sealwatch::is_decided(seen, desk, time, why_not);
  why_not = "its alarm was over at " + format_utc(over->second);
  return true;
}

bool RecalledAlarmActs::is_decided(const MaintenanceEvent& event, AlarmDesk& desk, UtcTime time,
                                   std::optional<std::string>& why_not) const {
  const auto act = alarm_act_of(event);
  const auto last = act ? last_said_.find({event.asset_id, act->alarm_id}) : last_said_.end();
  if (last != last_said_.end() && time_said(event) < last->second) {
    why_not = "what was said later, at " + format_utc(last->second) + ", counts";
    return true;
  }
  const bool waits = event.kind == kAlarmShelved && act && desk.entry_of(event.asset_id, act->alarm_id) == nullptr &&
                     *act->until > time;
  if (!waits) why_not = desk.apply(event, time);
  return !waits;
}

}  // namespace sealwatch

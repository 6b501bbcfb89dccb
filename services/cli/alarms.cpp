// `sealwatch shelve`, `unshelve`, `out-of-service` and `in-service`: what people do with alarms, besides acknowledging.
#include <algorithm>
#include <chrono>
#include <cstdio>

#include "sealwatch/core/text.hpp"
#include "sealwatch/core/visible_text.hpp"
#include "sealwatch/message/alarm_acts.hpp"
#include "sealwatch/message/alarm_state.hpp"
#include "services/cli/alarms_listed.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/operator_send.hpp"

namespace sealwatch::cli {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kKeeper = "advisory_generation";
/// Every service beats once a second, and soon after an act.
constexpr std::chrono::milliseconds kListen{2500};

MaintenanceEvent event_of(std::string_view kind, const std::string& asset_id, const std::string& by,
                          const std::string& reason, const AlarmAct& act) {
  MaintenanceEvent event;
  if (asset_id != kNoAsset) event.asset_id = asset_id;
  event.kind = kind;
  event.reported_by = by;
  event.remark = reason;
  event.header.event_time_known = true;
  event.header.event_time_ns = now_ns();
  event.header.message_id = alarm_act_id(event.asset_id, {event.header.event_time_ns}, act);
  return event;
}

/// Sends the act and waits until the alarms are as it asks for.
int do_act(std::optional<Session>& session, const MaintenanceEvent& event,
           const std::function<bool(const AlarmsListed&)>& is_done) {
  if (const int sent = send(session, event, {kKeeper}); sent != kOk) return sent;
  const AlarmsListed after = listen_for_alarms(*session->bus, is_done);
  if (is_done(after) || !after.complete) return kOk;
  complain(Error{.file = {},
                 .place = {},
                 .value = event.kind,
                 .rule = "was not done",
                 .advice = after.last_error.empty() ? "see `sealwatch audit`" : after.last_error});
  return kAnswerIsNo;
}

int changes_nothing(const std::string& what, const std::string& why) {
  complain(Error{.file = {}, .place = {}, .value = what, .rule = why, .advice = "see `sealwatch status`"});
  return kAnswerIsNo;
}

/// The bus with the alarms; nothing after a complaint.
std::optional<Session> open_with_alarms(const std::string& config, const std::string& asset_id, const std::string& by,
                                        AlarmsListed& alarms) {
  std::optional<Session> session = open_for(config, asset_id, by);
  if (!session) return std::nullopt;
  if (const Status joined = session->bus->subscribe_service_topics(); !joined) {
    complain(joined.error());
    return std::nullopt;
  }
  alarms = listen_for_alarms(*session->bus);
  return session;
}

}  // namespace

const AlarmEntry* AlarmsListed::find(const std::string& asset_id, const std::string& id) const {
  const std::string asset = asset_id == kNoAsset ? std::string() : asset_id;
  const auto found = std::ranges::find_if(
      entries, [&](const AlarmEntry& entry) { return entry.alarm.asset_id == asset && alarm_id(entry.alarm) == id; });
  return found == entries.end() ? nullptr : &*found;
}

Error AlarmsListed::unknown(const std::string& asset_id, const std::string& id) const {
  const std::string asset = asset_id == kNoAsset ? std::string() : asset_id;
  std::vector<std::string> known;
  for (const AlarmEntry& entry : entries)
    if (entry.alarm.asset_id == asset) known.push_back(alarm_id(entry.alarm));
  return Error{.file = {},
               .place = "alarm",
               .value = id,
               .rule = std::string("is not an alarm of ").append(asset.empty() ? "no asset" : asset),
               .advice = !heard          ? "advisory_generation, which keeps the alarms, is not heard"
                         : known.empty() ? "it has none; `sealwatch status --json` shows all alarms with their ids"
                                         : suggest(id, known)};
}

AlarmsListed listen_for_alarms(Bus& bus, const std::function<bool(const AlarmsListed&)>& is_enough) {
  AlarmsListed listed;
  const auto enough = [&] { return listed.heard && (!is_enough || is_enough(listed)); };
  for (const auto end = Clock::now() + kListen; Clock::now() < end && !enough();)
    for (const BusItem& item : bus.receive(std::chrono::milliseconds(50)))
      if (const auto* status = std::get_if<ServiceStatus>(&item); status != nullptr && status->service == kKeeper)
        listed = {.heard = true,
                  .entries = status->desk,
                  .complete = status->desk_count <= status->desk.size(),
                  .last_error = status->last_error};
  return listed;
}

int run_shelve(const ShelveOptions& options) {
  AlarmAct act{.alarm_id = options.alarm_id, .until = {}};
  const bool back = options.until.empty();
  if (!back) {
    auto until = parse_utc(options.until);
    if (!until) {
      until.error().place = "--until";
      complain(until.error());
      return kBadInput;
    }
    act.until = *until;
  }
  AlarmsListed alarms;
  auto session = open_with_alarms(options.config, options.asset_id, options.by, alarms);
  if (!session) return kBadInput;
  const AlarmEntry* const before = alarms.find(options.asset_id, options.alarm_id);
  if (before == nullptr && alarms.complete) {
    complain(alarms.unknown(options.asset_id, options.alarm_id));
    return kAnswerIsNo;
  }
  if (back && before != nullptr && before->shelved_until_ns == 0)
    return changes_nothing(options.alarm_id, "is not shelved");
  const MaintenanceEvent event =
      event_of(back ? kAlarmUnshelved : kAlarmShelved, options.asset_id, options.by, options.reason, act);
  const std::int64_t until_ns = back ? 0 : act.until->nanoseconds;
  const int done = do_act(session, event, [&](const AlarmsListed& now) {
    const AlarmEntry* const entry = now.find(options.asset_id, options.alarm_id);
    return entry == nullptr ? back : entry->shelved_until_ns == until_ns;
  });
  if (done != kOk) return done;
  if (back)
    std::printf("received: it is shown again\n");
  else
    std::printf("received: shelved until %s; to show it sooner: sealwatch unshelve %s %s --by NAME\n",
                format_utc(*act.until).c_str(), shell_word(options.asset_id).c_str(),
                shell_word(options.alarm_id).c_str());
  return kOk;
}

int run_out_of_service(const OutOfServiceOptions& options) {
  AlarmsListed alarms;
  auto session = open_with_alarms(options.config, options.asset_id, options.by, alarms);
  if (!session) return kBadInput;
  const MaintenanceEvent event =
      event_of(options.back ? kAssetInService : kAssetOutOfService, options.asset_id, options.by, options.reason, {});
  const std::string id(kOutOfServiceAlarm);
  if (options.back && alarms.heard && alarms.complete && alarms.find(options.asset_id, id) == nullptr)
    return changes_nothing(options.asset_id, "is not out of service");
  const int done = do_act(session, event, [&](const AlarmsListed& now) {
    const AlarmEntry* const entry = now.find(options.asset_id, id);
    return options.back ? entry == nullptr : entry != nullptr && entry->out_of_service_by == options.by;
  });
  if (done != kOk) return done;
  std::printf(options.back ? "received: %s is in service, its alarms are shown again\n"
                           : "received: %s is out of service, its alarms are out of view until it is taken back; what "
                             "is concluded stays the same\n",
              options.asset_id.c_str());
  return kOk;
}

}  // namespace sealwatch::cli

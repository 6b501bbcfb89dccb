// `sealwatch confirm`: a second person's word, where the configuration asks for one.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>

#include "sealwatch/message/confirmation.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/operator_send.hpp"

namespace sealwatch::cli {
namespace {

using Clock = std::chrono::steady_clock;

/// Every service beats once a second.
constexpr std::chrono::milliseconds kListen{2500};

/// What the services say, by service.
using Statuses = std::map<std::string, ServiceStatus>;

bool waits(const ServiceStatus& status, const std::string& act_id) {
  return std::ranges::any_of(status.alarms, [&](const ServiceAlarm& alarm) {
    return alarm.kind == "awaits_confirmation" && alarm.subject == act_id;
  });
}
bool waits(const Statuses& statuses, const std::string& act_id) {
  return std::ranges::any_of(statuses, [&](const auto& one) { return waits(one.second, act_id); });
}
/// A heartbeat names the newest alarms only.
bool tells_all(const Statuses& statuses) {
  return std::ranges::none_of(statuses,
                              [](const auto& one) { return one.second.alarm_count > one.second.alarms.size(); });
}

Statuses listen(Bus& bus) {
  Statuses statuses;
  for (const auto end = Clock::now() + kListen; Clock::now() < end;)
    for (const BusItem& item : bus.receive(std::chrono::milliseconds(100)))
      if (const auto* status = std::get_if<ServiceStatus>(&item)) statuses[status->service] = *status;
  return statuses;
}

int complain_of(const ConfirmOptions& options, const std::string& rule, const std::string& advice) {
  complain(Error{.file = {}, .place = "act", .value = options.act_id, .rule = rule, .advice = advice});
  return kAnswerIsNo;
}

}  // namespace

int run_confirm(const ConfirmOptions& options) {
  std::optional<Session> session = open_for(options.config, options.asset_id, options.by);
  if (!session) return kBadInput;
  if (const Status joined = session->bus->subscribe_service_topics(); !joined) {
    complain(joined.error());
    return kInternalFailure;
  }
  const Statuses before = listen(*session->bus);
  if (!waits(before, options.act_id) && tells_all(before))
    return complain_of(options, "waits for no confirmation", "`sealwatch status` shows what waits, with its id");
  MaintenanceEvent event;
  event.asset_id = options.asset_id;
  event.kind = options.reject ? kActRejected : kActConfirmed;
  event.reported_by = options.by;
  event.remark = options.remark;
  event.header.event_time_known = true;
  event.header.event_time_ns = now_ns();
  event.header.message_id = confirmation_id(options.asset_id, options.act_id, {event.header.event_time_ns});
  std::vector<std::string> readers;
  for (const auto& [service, status] : before)
    if (waits(status, options.act_id)) readers.push_back(service);
  if (const int sent = send(session, event, readers); sent != kOk) return sent;
  const Statuses after = listen(*session->bus);
  for (const auto& [service, status] : after)
    if (waits(status, options.act_id))
      return complain_of(options, options.reject ? "is not rejected" : "is not confirmed",
                         status.last_error.empty() ? "see `sealwatch audit`" : status.last_error);
  std::printf("%s by %s: it %s\n", options.reject ? "rejected" : "confirmed", options.by.c_str(),
              options.reject ? "never counts" : "counts now");
  return kOk;
}

}  // namespace sealwatch::cli

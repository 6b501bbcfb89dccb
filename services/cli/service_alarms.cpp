#include "services/cli/service_alarms.hpp"

#include <algorithm>
#include <array>

#include "sealwatch/core/time.hpp"
#include "sealwatch/core/visible_text.hpp"

namespace sealwatch::cli {
namespace {

constexpr std::string_view kNoHeartbeat = "no_heartbeat";

struct Row {
  std::string_view kind;
  Ne107 category;
  std::string_view meaning;
};
/// Failure: something is not concluded from. Function check: what is concluded may not be what is meant for use. Out of
/// specification: something goes on that the configuration does not foresee. Maintenance required: all is still seen,
/// and will not be for ever.
constexpr std::array kTable = {
    Row{kNoHeartbeat, Ne107::failure, "is not heard"},
    Row{"set_aside", Ne107::failure, "set aside after two failures"},
    Row{"rival", Ne107::out_of_specification, "not alone"},
    Row{"clock_step", Ne107::out_of_specification, "clock was set"},
    Row{"clock_unsynchronised", Ne107::maintenance_required, "clock is not synchronised"},
    Row{"sensor_lost", Ne107::failure, "sensor lost"},
    Row{"awaits_confirmation", Ne107::maintenance_required, "an act waits for a second person"},
    Row{"unknown_writer", Ne107::out_of_specification, "messages from an unknown writer"},
    Row{"refused_right", Ne107::out_of_specification, "somebody was refused"},
};

const Row* row_of(std::string_view kind) {
  const auto found = std::ranges::find(kTable, kind, &Row::kind);
  return found == kTable.end() ? nullptr : &*found;
}

}  // namespace

std::string_view words(Ne107 category) {
  constexpr std::array<std::string_view, 5> kWords = {"good", "failure", "function check", "out of specification",
                                                      "maintenance required"};
  return kWords.at(static_cast<std::size_t>(category));
}

Ne107 category_of(std::string_view alarm_kind) {
  const Row* const row = row_of(alarm_kind);
  return row == nullptr ? Ne107::failure : row->category;
}

std::vector<HeardAlarm> alarms_of(const std::vector<ServicesHeard::Service>& services) {
  std::vector<HeardAlarm> alarms;
  for (const ServicesHeard::Service& service : services) {
    if (!service.trouble.empty() && service.expected) {
      ServiceAlarm silent;
      silent.kind = kNoHeartbeat;
      silent.text = service.trouble;
      alarms.push_back({service.name, silent});
    }
    if (!service.heard) continue;
    for (const ServiceAlarm& alarm : service.last.alarms) alarms.push_back({service.name, alarm});
    if (service.last.alarm_count > service.last.alarms.size())
      alarms.back().untold = service.last.alarm_count - service.last.alarms.size();
  }
  return alarms;
}

bool is_blind(const std::vector<HeardAlarm>& alarms) {
  return std::ranges::any_of(
      alarms, [](const HeardAlarm& one) { return category_of(one.alarm.kind) != Ne107::maintenance_required; });
}

std::string one_line(const HeardAlarm& heard) {
  const ServiceAlarm& alarm = heard.alarm;
  const Row* const row = row_of(alarm.kind);
  std::string line = "ALARM (" + std::string(words(category_of(alarm.kind))) + ")  " + heard.service;
  if (!alarm.asset_id.empty()) line += "  " + alarm.asset_id;
  line += "  " + std::string(row == nullptr ? std::string_view(alarm.kind) : row->meaning);
  if (alarm.since_ns != 0) line += " since " + format_utc({alarm.since_ns});
  line += ": " + (alarm.subject.empty() ? "" : alarm.subject + ": ") + alarm.text;
  if (alarm.kind == "set_aside") line += " (sealwatch quarantine retry " + alarm.subject + " --by NAME)";
  if (alarm.kind == "awaits_confirmation")
    line += " (sealwatch confirm " + shell_word(alarm.asset_id) + " " + shell_word(alarm.subject) + " --by NAME)";
  if (heard.untold > 0) line += "; and " + std::to_string(heard.untold) + " more: sealwatch quarantine list";
  return line;
}

}  // namespace sealwatch::cli

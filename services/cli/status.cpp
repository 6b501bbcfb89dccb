// `sealwatch status`: what each service is doing, and the last word on every asset.
#include <chrono>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>

#include "sealwatch/message/alarm_state.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/operator_send.hpp"
#include "services/cli/service_alarms.hpp"
#include "services/cli/services_heard.hpp"
#include "services/cli/session.hpp"
#include "services/cli/status_overview.hpp"
#include "services/cli/summary.hpp"
#include "services/cli/supervisor.hpp"
#include "services/common/message/json.hpp"
#include "services/common/runtime/configuration_loader.hpp"

namespace sealwatch::cli {
namespace {

constexpr std::array kStateTopics = {Topic::state_report,      Topic::health_report,   Topic::leakage_estimate,
                                     Topic::remaining_life,    Topic::pst_request,     Topic::advisory,
                                     Topic::model_discrepancy, Topic::model_acceptance};

/// Where some services are heard, the others are waited for so much longer: they may just be starting.
constexpr std::chrono::seconds kPatienceForTheRest{3};
/// What they have concluded is there, and comes: on a busy machine, late.
constexpr std::chrono::seconds kPatienceForConclusions{15};

UtcTime now() { return {now_ns()}; }

/// What was heard while listening.
struct Heard {
  ServicesHeard services;
  std::map<std::string, AssetView> assets;
  std::map<std::string, std::map<std::string, std::string>> last;  ///< JSON by asset and topic

  void take(const BusItem& item) {
    if (const auto* status = std::get_if<ServiceStatus>(&item)) services.take(*status, ServicesHeard::Clock::now());
    if (const auto* message = std::get_if<Message>(&item)) {
      services.take(*message);
      assets[asset_of(*message)].take(*message);
      last[asset_of(*message)][std::string(name_of(topic_of(*message)))] = to_json(*message);
    }
  }
};

nlohmann::ordered_json as_json(const ServicesHeard::Service& service) {
  nlohmann::ordered_json result = {{"service", service.name}};
  if (service.heard) result = nlohmann::ordered_json::parse(to_json(service.last));
  if (!service.heard) result["state"] = service.trouble;
  result["trouble"] = service.trouble;
  return result;
}

std::string time_or_nothing(std::int64_t time_ns) { return time_ns == 0 ? "" : format_utc({time_ns}); }

/// "state" is "" where nobody keeps it: advisory_generation is not heard, or has not heard of the alarm yet.
nlohmann::ordered_json as_json(const HeardAlarm& heard) {
  const ServiceAlarm& alarm = heard.alarm;
  const AlarmEntry entry = heard.entry.value_or(AlarmEntry{});
  return {{"service", heard.service},
          {"id", alarm_id(heard.entry ? entry.alarm : alarm)},
          {"kind", alarm.kind},
          {"ne107", words(category_of(alarm.kind))},
          {"asset_id", alarm.asset_id},
          {"subject", alarm.subject},
          {"pst_id", alarm.pst_id},
          {"text", alarm.text},
          {"since", time_or_nothing(alarm.since_ns)},
          {"state", heard.entry ? name_of(state_of(entry, now())) : std::string_view()},
          {"ended", time_or_nothing(entry.ended_ns)},
          {"acknowledged_by", entry.acknowledged_by},
          {"shelved_by", entry.shelved_by},
          {"shelved_until", time_or_nothing(entry.shelved_until_ns)},
          {"shelved_reason", entry.shelved_reason},
          {"suppressed_by", entry.suppressed_by},
          {"out_of_service_by", entry.out_of_service_by}};
}

void print_json(const Heard& heard) {
  nlohmann::ordered_json result = {{"schema", "sealwatch.status/1"},
                                   {"services", nlohmann::ordered_json::array()},
                                   {"alarms", nlohmann::ordered_json::array()},
                                   {"assets", nlohmann::ordered_json::object()}};
  for (const auto& service : heard.services.list(ServicesHeard::Clock::now()))
    result["services"].push_back(as_json(service));
  for (const HeardAlarm& one : alarms_of(heard.services.list(ServicesHeard::Clock::now())))
    result["alarms"].push_back(as_json(one));
  for (const auto& [asset, topics] : heard.last)
    for (const auto& [topic, text] : topics) result["assets"][asset][topic] = nlohmann::ordered_json::parse(text);
  std::printf("%s\n", result.dump(1).c_str());
}

void print_text(const Heard& heard, const std::vector<std::string>& configured, double seconds) {
  if (heard.services.none()) {
    std::printf(
        "no service is running in this domain, or none was heard in %g s (start them with `sealwatch up`; on a busy "
        "machine, listen longer: --seconds %g)\n",
        seconds, 4.0 * seconds);
  } else {
    const std::vector<ServicesHeard::Service> services = heard.services.list(ServicesHeard::Clock::now());
    const std::vector<HeardAlarm> alarms = alarms_of(services);
    std::printf("%s\n", status_overview(services, alarms, heard.assets, now()).c_str());
    for (const auto& service : services) std::printf("%s\n", one_line(service).c_str());
    for (const HeardAlarm& alarm : alarms)
      if (!stands_in_advisory(alarm, now())) std::printf("%s", lines_of(alarm, now()).c_str());
  }
  for (const auto& [asset, view] : heard.assets) std::printf("\n%s", view.screen().c_str());
  if (heard.services.none()) return;
  for (const std::string& asset : configured)
    if (!heard.assets.contains(asset)) std::printf("\n== %s: in the configuration, not tested yet\n", asset.c_str());
}

std::vector<std::string> enabled_services(const Configuration& configuration) {
  std::vector<std::string> names;
  for (const std::string& name : service_names())
    if (enabled(configuration, name)) names.push_back(name);
  return names;
}

}  // namespace

int run_status(const StatusOptions& options) {
  std::optional<Session> session = open_session(options.config);
  if (!session) return kBadInput;
  Status joined = session->bus->subscribe(kStateTopics);
  if (joined) joined = session->bus->subscribe_service_topics();
  if (!joined) {
    complain(joined.error());
    return kInternalFailure;
  }
  catch_interrupts();
  Heard heard{
      .services = ServicesHeard(enabled_services(session->configuration), {kStateTopics.begin(), kStateTopics.end()}),
      .assets = {},
      .last = {}};
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(options.seconds);
  const auto go_on = [&] {
    const auto now = std::chrono::steady_clock::now();
    return now < end || (heard.services.incomplete() && now < end + kPatienceForTheRest) ||
           (heard.services.awaits_conclusions() && now < end + kPatienceForConclusions);
  };
  while (!interrupted() && go_on())
    for (const BusItem& item : session->bus->receive(std::chrono::milliseconds(100))) heard.take(item);
  std::vector<std::string> configured;
  for (const AssetConfig& asset : session->configuration.assets) configured.push_back(asset.asset_id);
  options.json ? print_json(heard) : print_text(heard, configured, options.seconds);
  const auto listened = ServicesHeard::Clock::now();
  const bool well = !heard.services.none() && heard.services.all_well(listened) &&
                    !is_blind(alarms_of(heard.services.list(listened)), now());
  return well ? kOk : kAnswerIsNo;
}

}  // namespace sealwatch::cli

// `sealwatch status`: what each service is doing, and the last word on every asset.
#include <chrono>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>

#include "services/cli/commands.hpp"
#include "services/cli/service_alarms.hpp"
#include "services/cli/services_heard.hpp"
#include "services/cli/session.hpp"
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

/// What was heard while listening.
struct Heard {
  ServicesHeard services;
  std::map<std::string, AssetView> assets;
  std::map<std::string, std::map<std::string, std::string>> last;  ///< JSON by asset and topic

  void take(const BusItem& item) {
    if (const auto* status = std::get_if<ServiceStatus>(&item)) services.take(*status, ServicesHeard::Clock::now());
    if (const auto* message = std::get_if<Message>(&item)) {
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

void print_json(const Heard& heard) {
  nlohmann::ordered_json result = {{"schema", "sealwatch.status/1"},
                                   {"services", nlohmann::ordered_json::array()},
                                   {"alarms", nlohmann::ordered_json::array()},
                                   {"assets", nlohmann::ordered_json::object()}};
  for (const auto& service : heard.services.list(ServicesHeard::Clock::now()))
    result["services"].push_back(as_json(service));
  for (const HeardAlarm& one : alarms_of(heard.services.list(ServicesHeard::Clock::now())))
    result["alarms"].push_back({{"service", one.service},
                                {"kind", one.alarm.kind},
                                {"ne107", words(category_of(one.alarm.kind))},
                                {"asset_id", one.alarm.asset_id},
                                {"subject", one.alarm.subject},
                                {"pst_id", one.alarm.pst_id},
                                {"text", one.alarm.text},
                                {"since", one.alarm.since_ns == 0 ? "" : format_utc({one.alarm.since_ns})}});
  for (const auto& [asset, topics] : heard.last)
    for (const auto& [topic, text] : topics) result["assets"][asset][topic] = nlohmann::ordered_json::parse(text);
  std::printf("%s\n", result.dump(1).c_str());
}

void print_text(const Heard& heard, const std::vector<std::string>& configured) {
  if (heard.services.none()) {
    std::printf("no service is running in this domain (start them with `sealwatch up`)\n");
  } else {
    for (const auto& service : heard.services.list(ServicesHeard::Clock::now()))
      std::printf("%s\n", one_line(service).c_str());
    for (const HeardAlarm& alarm : alarms_of(heard.services.list(ServicesHeard::Clock::now())))
      std::printf("%s\n", one_line(alarm).c_str());
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
  Heard heard{.services = ServicesHeard(enabled_services(session->configuration)), .assets = {}, .last = {}};
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(options.seconds);
  const auto go_on = [&] {
    const auto now = std::chrono::steady_clock::now();
    return now < end || (heard.services.incomplete() && now < end + kPatienceForTheRest);
  };
  while (!interrupted() && go_on())
    for (const BusItem& item : session->bus->receive(std::chrono::milliseconds(100))) heard.take(item);
  std::vector<std::string> configured;
  for (const AssetConfig& asset : session->configuration.assets) configured.push_back(asset.asset_id);
  options.json ? print_json(heard) : print_text(heard, configured);
  const auto now = ServicesHeard::Clock::now();
  const bool well =
      !heard.services.none() && heard.services.all_well(now) && !is_blind(alarms_of(heard.services.list(now)));
  return well ? kOk : kAnswerIsNo;
}

}  // namespace sealwatch::cli

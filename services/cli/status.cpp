// `sealwatch status`: what each service is doing, and the last word on every asset.
#include <chrono>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>

#include "services/cli/commands.hpp"
#include "services/cli/session.hpp"
#include "services/cli/summary.hpp"
#include "services/common/message/json.hpp"

namespace sealwatch::cli {
namespace {

constexpr std::array kStateTopics = {Topic::state_report,      Topic::health_report,   Topic::leakage_estimate,
                                     Topic::remaining_life,    Topic::pst_request,     Topic::advisory,
                                     Topic::model_discrepancy, Topic::model_acceptance};

/// What was heard while listening.
struct Heard {
  std::map<std::string, ServiceStatus> services;
  std::map<std::string, AssetView> assets;
  std::map<std::string, std::map<std::string, std::string>> last;  ///< JSON by asset and topic

  void take(const BusItem& item) {
    if (const auto* status = std::get_if<ServiceStatus>(&item)) services[status->service] = *status;
    if (const auto* message = std::get_if<Message>(&item)) {
      assets[asset_of(*message)].take(*message);
      last[asset_of(*message)][std::string(name_of(topic_of(*message)))] = to_json(*message);
    }
  }
};

void print_json(const Heard& heard) {
  nlohmann::ordered_json result = {{"schema", "sealwatch.status/1"},
                                   {"services", nlohmann::ordered_json::array()},
                                   {"assets", nlohmann::ordered_json::object()}};
  for (const auto& [name, status] : heard.services)
    result["services"].push_back(nlohmann::ordered_json::parse(to_json(status)));
  for (const auto& [asset, topics] : heard.last)
    for (const auto& [topic, text] : topics) result["assets"][asset][topic] = nlohmann::ordered_json::parse(text);
  std::printf("%s\n", result.dump(1).c_str());
}

void print_text(const Heard& heard) {
  for (const auto& [name, status] : heard.services) std::printf("%s\n", one_line(status).c_str());
  if (heard.services.empty()) std::printf("no service is running in this domain (start them with `sealwatch up`)\n");
  for (const auto& [asset, view] : heard.assets) std::printf("\n%s", view.screen().c_str());
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
  Heard heard;
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(options.seconds);
  while (!interrupted() && std::chrono::steady_clock::now() < end)
    for (const BusItem& item : session->bus->receive(std::chrono::milliseconds(100))) heard.take(item);
  options.json ? print_json(heard) : print_text(heard);
  return heard.services.empty() ? kAnswerIsNo : kOk;
}

}  // namespace sealwatch::cli

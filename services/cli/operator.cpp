// `sealwatch acknowledge` and `sealwatch replaced`: what people tell the system.
#include <chrono>
#include <cstdio>
#include <functional>

#include "sealwatch/core/time.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/session.hpp"

namespace sealwatch::cli {
namespace {

/// The reader's heartbeat confirms receipt; without it after this time the command says so and fails.
constexpr std::chrono::seconds kPatience{10};

std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

/// Publishes one message as a stream of its own and waits until every one of `readers` has journaled it.
int send(const std::string& config, Message message, std::vector<std::string> readers) {
  std::optional<Session> session = open_session(config);
  if (!session) return kBadInput;
  if (session->configuration.find_asset(asset_of(message)) == nullptr) {
    complain(Error{.file = config,
                   .place = "assets",
                   .value = asset_of(message),
                   .rule = "is not a configured asset",
                   .advice = {}});
    return kBadInput;
  }
  const std::string topic(name_of(topic_of(message)));
  Header& header = header_of(message);
  header.writer_id = unique_name("operator");
  header.stream_sequence = 1;
  header.producer = "sealwatch command line " SEALWATCH_VERSION;
  Status done = session->bus->subscribe_service_topics();
  if (done) done = session->bus->publish(message);
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (done && !readers.empty() && std::chrono::steady_clock::now() < end) {
    for (const BusItem& item : session->bus->receive(std::chrono::milliseconds(100))) {
      if (const auto* request = std::get_if<ResendRequest>(&item);
          request != nullptr && request->writer_id == header.writer_id)
        done = session->bus->publish(message);
      if (const auto* status = std::get_if<ServiceStatus>(&item))
        for (const StreamPosition& position : status->received)
          if (position.writer_id == header.writer_id) std::erase(readers, status->service);
    }
  }
  if (!done) {
    complain(done.error());
    return kInternalFailure;
  }
  if (readers.empty()) {
    std::printf("received\n");
    return kOk;
  }
  complain(Error{.file = {},
                 .place = topic,
                 .value = {},
                 .rule = "was not received by " + readers.front() + " within 10 s",
                 .advice = "is it running? see `sealwatch status`"});
  return kAnswerIsNo;
}

}  // namespace

int run_acknowledge(const AcknowledgeOptions& options) {
  Acknowledgement message;
  message.asset_id = options.asset_id;
  message.advisory_id = options.advisory_id;
  message.acknowledged_by = options.by;
  message.remark = options.remark;
  message.header.event_time_known = true;
  message.header.event_time_ns = now_ns();
  message.header.message_id =
      "acknowledgement/" + options.advisory_id + "/" + std::to_string(message.header.event_time_ns);
  return send(options.config, message, {"advisory_generation"});
}

int run_replaced(const ReplacedOptions& options) {
  Result<UtcTime> at = parse_utc(options.at);
  if (!at) {
    at.error().place = "--at";
    complain(at.error());
    return kBadInput;
  }
  if (at->nanoseconds > now_ns()) {  // a slip in the year would set aside every test until then
    complain(Error{.file = {},
                   .place = "--at",
                   .value = options.at,
                   .rule = "lies in the future",
                   .advice = "report a replacement once it has been done"});
    return kBadInput;
  }
  MaintenanceEvent message;
  message.asset_id = options.asset_id;
  message.kind = options.what + "_replaced";
  message.reported_by = options.by;
  message.remark = options.remark;
  message.header.event_time_known = true;
  message.header.event_time_ns = at->nanoseconds;
  message.header.message_id = "maintenance_event/" + options.asset_id + "/" + format_utc(*at);
  return send(options.config, message, {"state_detection", "prognostic_assessment", "advisory_generation"});
}

}  // namespace sealwatch::cli

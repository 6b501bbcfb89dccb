// `sealwatch acknowledge`, `sealwatch replaced` and `sealwatch accept`: what people tell the system.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <functional>

#include "sealwatch/core/time.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/session.hpp"
#include "services/cli/terminal.hpp"

namespace sealwatch::cli {
namespace {

/// The reader's heartbeat confirms receipt; without it after this time the command says so and fails.
constexpr std::chrono::seconds kPatience{10};
/// The answer follows the receipt within the same batch.
constexpr std::chrono::seconds kPatienceForAnswer{2};
constexpr std::array kAdvisory = {Topic::advisory};

std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

/// Publishes one message as a stream of its own and waits until every one of `readers` has journaled it. What else
/// comes on the bus meanwhile goes to `look`.
int send(std::optional<Session>& session, const std::string& config, Message message, std::vector<std::string> readers,
         const std::function<void(const Message&)>& look = {}) {
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
      if (const auto* other = std::get_if<Message>(&item); other != nullptr && look) look(*other);
    }
  }
  if (!done) {
    complain(done.error());
    return kInternalFailure;
  }
  if (readers.empty()) return kOk;
  complain(Error{.file = {},
                 .place = topic,
                 .value = {},
                 .rule = "was not received by " + readers.front() + " within 10 s",
                 .advice = "is it running? see `sealwatch status`"});
  return kAnswerIsNo;
}

/// What the advisories say about an acknowledgement.
class Answer {
 public:
  explicit Answer(const Acknowledgement& question) : question_(question) {}

  void look(const Message& message) {
    const auto* advisory = std::get_if<Advisory>(&message);
    if (advisory == nullptr || advisory->asset_id != question_.asset_id) return;
    const auto& causes = advisory->header.source_ids;
    if (std::find(causes.begin(), causes.end(), question_.header.message_id) != causes.end()) answer_ = *advisory;
    if (advisory->state != AdvisoryState::superseded) current_ = *advisory;
  }
  [[nodiscard]] bool given() const { return answer_.has_value(); }

  /// Prints what became of it.
  [[nodiscard]] int conclude() const {
    if (current_ && current_->advisory_id == question_.advisory_id && current_->state == AdvisoryState::acknowledged) {
      std::printf("acknowledged by %s\n", current_->acknowledged_by.c_str());
      return kOk;
    }
    const bool other = current_ && current_->advisory_id != question_.advisory_id;
    complain(Error{.file = {},
                   .place = "advisory",
                   .value = question_.advisory_id,
                   .rule = current_ ? (other ? "is not the advisory in force for this asset" : "was not acknowledged")
                                    : "is not known: there is no advisory for asset " + question_.asset_id,
                   .advice = other ? "the one in force is " + current_->advisory_id : "see `sealwatch status`"});
    return kAnswerIsNo;
  }

 private:
  Acknowledgement question_;
  std::optional<Advisory> current_;
  std::optional<Advisory> answer_;
};

/// The latest word of the mismatch analysis on the asset, if one comes.
std::optional<ModelDiscrepancy> latest_discrepancy(Bus& bus, const std::string& asset_id) {
  std::optional<ModelDiscrepancy> latest;
  const auto end = std::chrono::steady_clock::now() + kPatienceForAnswer;
  while (std::chrono::steady_clock::now() < end)
    for (const BusItem& item : bus.receive(std::chrono::milliseconds(100)))
      if (const auto* message = std::get_if<Message>(&item))
        if (const auto* found = std::get_if<ModelDiscrepancy>(message); found != nullptr && found->asset_id == asset_id)
          latest = *found;
  return latest;
}

/// Only a model that explains something, and only the latest, comes into force.
std::optional<Error> objection(const std::optional<ModelDiscrepancy>& latest, const AcceptOptions& options) {
  Error error{.file = {}, .place = "--discrepancy", .value = options.discrepancy_id, .rule = {}, .advice = {}};
  if (!latest) {
    error.rule = "is not known: there is no model_discrepancy for asset " + options.asset_id;
    error.advice = "is health_assessment running? see `sealwatch status`";
  } else if (latest->header.message_id != options.discrepancy_id) {
    error.rule = "is not the latest for asset " + options.asset_id;
    error.advice = "the latest is " + latest->header.message_id;
  } else if (!latest->analysed || latest->verdict != DiscrepancyVerdict::mismatch || latest->physics.empty()) {
    error.rule = "explains nothing that could be accepted";
    error.advice = latest->analysed ? latest->summary : latest->failure;
  } else {
    return std::nullopt;
  }
  return error;
}

}  // namespace

int run_accept(const AcceptOptions& options) {
  constexpr std::array kDiscrepancy = {Topic::model_discrepancy};
  std::optional<Session> session = open_session(options.config);
  if (!session) return kBadInput;
  ModelAcceptance message;
  message.asset_id = options.asset_id;
  message.discrepancy_id = options.discrepancy_id;
  message.revoked = options.revoke;
  message.accepted_by = options.by;
  message.remark = options.remark;
  message.header.event_time_known = true;
  message.header.event_time_ns = now_ns();
  message.header.message_id =
      "model_acceptance/" + options.asset_id + "/" + std::to_string(message.header.event_time_ns);
  if (!options.revoke) {
    if (const Status joined = session->bus->subscribe(kDiscrepancy); !joined) {
      complain(joined.error());
      return kInternalFailure;
    }
    const std::optional<ModelDiscrepancy> latest = latest_discrepancy(*session->bus, options.asset_id);
    if (const auto error = objection(latest, options)) {
      complain(*error);
      return kAnswerIsNo;
    }
    message.version = latest->version;
    message.discrepancy_time_ns = latest->header.event_time_ns;
    message.explained = latest->explained;
    message.header.source_ids = {latest->header.message_id};
  }
  const int sent = send(session, options.config, message, {"state_detection", "prognostic_assessment"});
  if (sent == kOk)
    std::printf(
        "received: from the next test on %s is simulated with %s\n", options.asset_id.c_str(),
        options.revoke ? "its file's model" : "the explained model, and judged against its file's model besides");
  return sent;
}

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
  std::optional<Session> session = open_session(options.config);
  if (session)
    if (const Status joined = session->bus->subscribe(kAdvisory); !joined) {
      complain(joined.error());
      return kInternalFailure;
    }
  Answer answer(message);
  const auto look = [&answer](const Message& other) { answer.look(other); };
  if (const int sent = send(session, options.config, message, {"advisory_generation"}, look); sent != kOk) return sent;
  // One that is acknowledged already, or of an asset without advice, gets no answer.
  const auto end = std::chrono::steady_clock::now() + kPatienceForAnswer;
  while (!answer.given() && std::chrono::steady_clock::now() < end)
    for (const BusItem& item : session->bus->receive(std::chrono::milliseconds(100)))
      if (const auto* other = std::get_if<Message>(&item)) look(*other);
  return answer.conclude();
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
  std::optional<Session> session = open_session(options.config);
  const int sent =
      send(session, options.config, message, {"state_detection", "prognostic_assessment", "advisory_generation"});
  if (sent == kOk)
    std::printf("received: the history of %s begins anew on %s\n", options.asset_id.c_str(),
                date(at->nanoseconds).c_str());
  return sent;
}

}  // namespace sealwatch::cli

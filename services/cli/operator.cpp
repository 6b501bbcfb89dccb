// `sealwatch acknowledge`, `sealwatch replaced` and `sealwatch accept`: what people tell the system.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <functional>

#include "sealwatch/core/text.hpp"
#include "sealwatch/core/time.hpp"
#include "sealwatch/core/visible_text.hpp"
#include "sealwatch/message/alarm_state.hpp"
#include "sealwatch/message/replacement_id.hpp"
#include "services/cli/alarms_listed.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/operator_send.hpp"
#include "services/cli/session.hpp"
#include "services/cli/terminal.hpp"
#include "services/prognostic_assessment/asset_history.hpp"

namespace sealwatch::cli {
namespace {

/// The answer follows the receipt within the same batch.
constexpr std::chrono::seconds kPatienceForAnswer{2};
constexpr std::array kAdvisory = {Topic::advisory};

/// A message about an asset, by somebody, now.
template <typename M>
M said_by(const std::string& who, const std::string& asset_id, const std::string& subject) {
  M message;
  message.asset_id = asset_id;
  message.header.event_time_known = true;
  message.header.event_time_ns = now_ns();
  message.header.message_id = std::string(name_of(topic_of(Message(message)))) + "/" + subject + "/" +
                              std::to_string(message.header.event_time_ns);
  if constexpr (requires { message.accepted_by; })
    message.accepted_by = who;
  else
    message.acknowledged_by = who;
  return message;
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

/// What the mismatch analysis said of the asset last, and whose model it is estimated with.
struct Explained {
  std::optional<ModelDiscrepancy> latest;
  std::string accepted_id;  ///< of the last test; "" when none is

  explicit Explained(Bus& bus, const std::string& asset_id) {
    const auto end = std::chrono::steady_clock::now() + kPatienceForAnswer;
    while (std::chrono::steady_clock::now() < end)
      for (const BusItem& item : bus.receive(std::chrono::milliseconds(100)))
        if (const auto* message = std::get_if<Message>(&item); message != nullptr && asset_of(*message) == asset_id) {
          if (const auto* found = std::get_if<ModelDiscrepancy>(message)) latest = *found;
          if (const auto* estimate = std::get_if<LeakageEstimate>(message))
            accepted_id = estimate->accepted_discrepancy;
        }
  }
};

/// Only a model that explains something, and only the latest, comes into force; only one that can be is revoked.
std::optional<Error> objection(const Explained& explained, const AcceptOptions& options) {
  const std::optional<ModelDiscrepancy>& latest = explained.latest;
  Error error{.file = {}, .place = "--discrepancy", .value = options.discrepancy_id, .rule = {}, .advice = {}};
  const bool is_latest = latest && latest->header.message_id == options.discrepancy_id;
  const bool is_accepted = !explained.accepted_id.empty() && explained.accepted_id == options.discrepancy_id;
  if (options.revoke && (is_latest || is_accepted)) return std::nullopt;
  if (options.revoke && !explained.accepted_id.empty()) {
    error.rule = "is not what was accepted for asset " + options.asset_id;
    error.advice = "its last test was estimated with " + explained.accepted_id;
  } else if (!latest) {
    error.rule = "is not known: there is no model_discrepancy for asset " + options.asset_id;
    error.advice = "is health_assessment running? see `sealwatch status`";
  } else if (!is_latest) {
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

/// Of the latest replacement of the asset that prognosis knew before: the last remaining_life.
std::optional<RemainingLife> known_replacement(Bus& bus, const std::string& asset_id) {
  const auto end = std::chrono::steady_clock::now() + kPatienceForAnswer;
  std::optional<RemainingLife> last;
  while (!last && std::chrono::steady_clock::now() < end)
    for (const BusItem& item : bus.receive(std::chrono::milliseconds(100)))
      if (const auto* message = std::get_if<Message>(&item); message != nullptr && asset_of(*message) == asset_id)
        if (const auto* life = std::get_if<RemainingLife>(message)) last = *life;
  return last && last->replacement_known ? last : std::nullopt;
}

}  // namespace

int run_accept(const AcceptOptions& options) {
  constexpr std::array kExplained = {Topic::model_discrepancy, Topic::leakage_estimate};
  std::optional<Session> session = open_for(options.config, options.asset_id, options.by);
  if (!session) return kBadInput;
  auto message = said_by<ModelAcceptance>(options.by, options.asset_id, options.asset_id);
  message.discrepancy_id = options.discrepancy_id;
  message.revoked = options.revoke;
  message.remark = options.remark;
  if (const Status joined = session->bus->subscribe(kExplained); !joined) {
    complain(joined.error());
    return kInternalFailure;
  }
  const Explained explained(*session->bus, options.asset_id);
  if (const auto error = objection(explained, options)) {
    complain(*error);
    return kAnswerIsNo;
  }
  if (!options.revoke) {
    message.version = explained.latest->version;
    message.discrepancy_time_ns = explained.latest->header.event_time_ns;
    message.explained = explained.latest->explained;
    message.header.source_ids = {explained.latest->header.message_id};
  }
  const int sent = send(session, message, {"state_detection", "prognostic_assessment"});
  if (sent == kOk && !options.revoke && says_that_it_waits(*session, message)) return kOk;
  if (sent == kOk)
    std::printf(
        "received: from the next test on %s is simulated with %s\n", options.asset_id.c_str(),
        options.revoke ? "its file's model" : "the explained model, and judged against its file's model besides");
  return sent;
}

namespace {

/// Alarms of services, and advisories that ended unseen, answer by their state.
int acknowledge_alarm(std::optional<Session>& session, const AcknowledgeOptions& options, Acknowledgement message) {
  if (message.asset_id == kNoAsset) message.asset_id.clear();
  if (const int sent = send(session, message, {"advisory_generation"}); sent != kOk) return sent;
  const auto is_done = [&](const AlarmsListed& now) {
    const AlarmEntry* const entry = now.find(options.asset_id, options.advisory_id);
    return entry == nullptr || entry->acknowledged_by == options.by;
  };
  if (const AlarmsListed after = listen_for_alarms(*session->bus, is_done); !is_done(after)) {
    complain(Error{.file = {},
                   .place = "alarm",
                   .value = options.advisory_id,
                   .rule = "was not acknowledged",
                   .advice = after.last_error.empty() ? "see `sealwatch audit`" : after.last_error});
    return kAnswerIsNo;
  }
  std::printf("acknowledged by %s\n", options.by.c_str());
  return kOk;
}

/// Whether it is no advisory in force, but something else that the services keep.
bool is_alarm(Bus& bus, const AcknowledgeOptions& options) {
  const AlarmsListed alarms = listen_for_alarms(bus);
  const AlarmEntry* const entry = alarms.find(options.asset_id, options.advisory_id);
  return entry != nullptr && (!is_advice(entry->alarm) || entry->ended_ns != 0);
}

}  // namespace

int run_acknowledge(const AcknowledgeOptions& options) {
  std::optional<Session> session = open_for(options.config, options.asset_id, options.by);
  if (!session) return kBadInput;
  if (const Status joined = session->bus->subscribe_service_topics(); !joined) {
    complain(joined.error());
    return kInternalFailure;
  }
  auto message = said_by<Acknowledgement>(options.by, options.asset_id, options.advisory_id);
  message.advisory_id = options.advisory_id;
  message.remark = options.remark;
  if (is_alarm(*session->bus, options)) return acknowledge_alarm(session, options, message);
  if (const Status joined = session->bus->subscribe(kAdvisory); !joined) {
    complain(joined.error());
    return kInternalFailure;
  }
  Answer answer(message);
  const auto look = [&answer](const Message& other) { answer.look(other); };
  if (const int sent = send(session, message, {"advisory_generation"}, look); sent != kOk) return sent;
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
  message.header.message_id = replacement_id(options.asset_id, message.kind, {now_ns()}, *at);
  std::optional<Session> session = open_for(options.config, options.asset_id, options.by);
  if (!session) return kBadInput;
  constexpr std::array kLife = {Topic::remaining_life};
  if (const Status joined = session->bus->subscribe(kLife); !joined) {
    complain(joined.error());
    return kInternalFailure;
  }
  const std::optional<RemainingLife> known = known_replacement(*session->bus, options.asset_id);
  const bool later = known && known->replaced_ns > at->nanoseconds;
  // The same one may have reached only some of the services: it is sent again, under the name that they know. A report
  // of another kind is another one: under that name nobody would take it.
  const std::string known_id = known ? prognostic_assessment::replacement_of(*known).id : std::string();
  if (known && known->replaced_ns == at->nanoseconds && may_report(known_id, options.asset_id, message.kind))
    message.header.message_id = known_id;
  const int sent = later ? kOk : send(session, message, kReadersOfMaintenance);
  if (sent == kOk && known && known->replaced_ns >= at->nanoseconds) {
    const std::string day = date(known->replaced_ns);
    complain(Error{.file = {},
                   .place = "--at",
                   .value = options.at,
                   .rule = "changes nothing: a replacement on " + day + " is known already" +
                           (later ? ", which is later" : "") + "; only tests since " + day + " count",
                   .advice = {}});
    return kAnswerIsNo;
  }
  if (sent == kOk && says_that_it_waits(*session, message)) return kOk;
  if (sent == kOk)
    std::printf(
        "received: only tests of %s since %s count for the new %s\n"
        "taken back by: sealwatch retract %s --withdraw %s --by NAME --reason WHY\n",
        options.asset_id.c_str(), date(at->nanoseconds).c_str(), options.what.c_str(),
        shell_word(options.asset_id).c_str(), shell_word(message.header.message_id).c_str());
  return sent;
}

}  // namespace sealwatch::cli

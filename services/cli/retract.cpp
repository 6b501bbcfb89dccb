// `sealwatch retract`: tests that must not count, or count again.
#include <chrono>
#include <cstdio>

#include "sealwatch/core/visible_text.hpp"
#include "sealwatch/message/confirmation.hpp"
#include "sealwatch/message/retraction.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/operator_send.hpp"
#include "services/cli/retraction_effect.hpp"

namespace sealwatch::cli {
namespace {

/// Prognosis concludes anew as soon as it has received the act.
constexpr std::chrono::seconds kPatienceForLife{3};

/// Kind and what it says, or nothing after an objection.
std::optional<MaintenanceEvent> event_of(const RetractOptions& options) {
  MaintenanceEvent event;
  event.asset_id = options.asset_id;
  event.reported_by = options.by;
  event.remark = options.reason;
  event.header.event_time_known = true;
  event.header.event_time_ns = now_ns();
  std::string what = options.pst_id.empty() ? options.withdraw : options.pst_id;
  event.kind = options.pst_id.empty() ? kRetractionWithdrawn : kTestRetracted;
  if (!options.since.empty()) {
    Result<UtcTime> since = parse_utc(options.since);
    if (!since) {
      since.error().place = "--since";
      complain(since.error());
      return std::nullopt;
    }
    event.kind = kTestsRetracted;
    what = format_utc(*since);
  }
  event.header.message_id = retraction_id(options.asset_id, event.kind, what, {event.header.event_time_ns});
  const auto earlier = retraction_of(options.asset_id, what);
  if (event.kind == kRetractionWithdrawn && earlier && !earlier->withdrawn_id.empty()) {
    complain(Error{.file = {},
                   .place = "--withdraw",
                   .value = what,
                   .rule = "withdrew something, which cannot be taken back",
                   .advice = "retract the tests once more, or report the replacement again"});
    return std::nullopt;
  }
  const bool can_be_withdrawn =
      earlier || (time_of_replacement(what) && what.starts_with("maintenance_event/" + options.asset_id + "/"));
  if (event.kind != kRetractionWithdrawn || can_be_withdrawn) return event;
  complain(Error{.file = {},
                 .place = "--withdraw",
                 .value = what,
                 .rule = "is neither a retraction nor a replacement of asset " + options.asset_id,
                 .advice = "give the id printed by sealwatch retract or replaced, or shown by sealwatch audit"});
  return std::nullopt;
}

/// Sends it, and hears what prognosis, where it tells of this asset at all, answers, and told last before.
int send_and_hear(std::optional<Session>& session, const MaintenanceEvent& event, bool is_answered, KnownTests& known,
                  std::optional<RemainingLife>& answer) {
  const auto look = [&](const Message& message) {
    const auto* life = std::get_if<RemainingLife>(&message);
    if (life != nullptr && life->asset_id == event.asset_id) hear(*life, event.header.message_id, known, answer);
  };
  const int sent = send(session, event, kReadersOfMaintenance, look);
  if (sent != kOk || !is_answered) return sent;
  for (const auto end = std::chrono::steady_clock::now() + kPatienceForLife;
       !answer && std::chrono::steady_clock::now() < end;)
    for (const BusItem& item : session->bus->receive(std::chrono::milliseconds(100)))
      if (const auto* message = std::get_if<Message>(&item)) look(*message);
  return sent;
}

}  // namespace

int run_retract(const RetractOptions& options) {
  const std::optional<MaintenanceEvent> event = event_of(options);
  if (!event) return kBadInput;
  std::optional<Session> session = open_for(options.config, options.asset_id, options.by);
  if (!session) return kBadInput;
  KnownTests known = known_tests(*session, options);
  if (const auto error = objection(known, options)) {
    complain(*error);
    return kAnswerIsNo;
  }
  const bool waits = session->configuration.acts_confirmed_by_second && may_lower_an_advisory(*event);
  const AssetConfig* const asset = session->configuration.find_asset(options.asset_id);
  std::optional<RemainingLife> answer;
  const int sent = send_and_hear(session, *event, !waits && asset != nullptr && asset->condition, known, answer);
  if (sent != kOk || says_that_it_waits(*session, *event)) return sent;
  if (const auto error = answer ? objection(known, *answer, options) : std::nullopt) {
    complain(*error);
    return kAnswerIsNo;
  }
  const bool withdrawn = event->kind == kRetractionWithdrawn;
  const char* const what = !withdrawn                              ? "these tests no longer count"
                           : time_of_replacement(options.withdraw) ? "the tests before this replacement count again"
                                                                   : "these tests count again";
  std::printf("received: %s; the remaining life and the advice are concluded anew\n", what);
  if (!withdrawn)
    std::printf("taken back by: sealwatch retract %s --withdraw %s --by NAME --reason WHY\n",
                shell_word(options.asset_id).c_str(), shell_word(event->header.message_id).c_str());
  return kOk;
}

}  // namespace sealwatch::cli

// The runner's part in the states of alarms (alarm_desk.hpp), where its service keeps them: what the desk hears, what
// people say to it, and its place in the journal.
#include <iterator>
#include <utility>

#include "services/common/runtime/layer_runner.hpp"
#include "services/common/runtime/log.hpp"
#include "services/common/runtime/operator_acts.hpp"

namespace sealwatch {
namespace {

/// Also where there is nothing to take back yet: what was said before it counts no more.
bool takes_back(std::string_view kind) { return kind == kAlarmUnshelved || kind == kAssetInService; }

AlarmDesk::Steady steady_now() { return std::chrono::steady_clock::now().time_since_epoch(); }

}  // namespace

Status LayerRunner::open_desk() {
  if (!options_.desk) return {};
  auto kept = journal_.alarms();
  if (!kept) return fail(kept.error());
  desk_.emplace(*options_.desk, std::move(*kept), steady_now(), clock_.now());
  if (Status restored = restore_recalled_at_desk(); !restored) return restored;
  return let_time_pass_at_desk();
}

/// Those that wait for their alarm are not of the layer's acts ahead. The audit trail tells what was said last of each.
Status LayerRunner::restore_recalled_at_desk() {
  const auto acts = journal_.acts();
  if (!acts) return fail(acts.error());
  for (const AuditEntry& entry : *acts) {
    if (is_taken(entry.act.outcome) || takes_back(entry.act.kind))
      recalled_.note_said(entry.act.kind, entry.act.asset_id, entry.act.subject);
    if (entry.act.who.empty()) recalled_.note_over(entry.act.asset_id, entry.act.subject);
  }
  for (auto ahead = acts_ahead_.begin(); ahead != acts_ahead_.end();) {
    const auto ids = journal_.acts_ahead(ahead->first);
    if (!ids) return fail(ids.error());
    for (const std::string& act_id : *ids) {
      auto act = journal_.input(act_id);
      if (!act) return fail(act.error());
      if (!*act || !is_for_desk(**act, true)) continue;
      recalled_.add(std::move(**act));
      said_ahead_.erase(act_id);
      --ahead->second;
    }
    if (ahead->second == 0) awaits_quiet_.erase(ahead->first);
    ahead = ahead->second == 0 ? acts_ahead_.erase(ahead) : std::next(ahead);
  }
  return {};
}

void LayerRunner::note_advice_of(const Message& output) {
  const auto said = desk_ && options_.advice_of_output ? options_.advice_of_output(output) : std::nullopt;
  if (said) desk_->stand(*said, clock_.now());
}

bool LayerRunner::is_for_desk(const Message& message, bool is_fetched_back) const {
  const auto* event = std::get_if<MaintenanceEvent>(&message);
  if (event != nullptr) return is_alarm_act(event->kind);
  const auto* seen = std::get_if<Acknowledgement>(&message);
  if (seen == nullptr || !desk_) return false;
  return is_fetched_back ? !is_advisory_id(seen->advisory_id) : desk_->takes(*seen);
}

std::optional<std::string> LayerRunner::tell_desk(const Message& message) {
  if (!desk_) return std::nullopt;
  std::optional<std::string> refused;
  if (const auto* seen = std::get_if<Acknowledgement>(&message)) desk_->acknowledge(*seen, clock_.now());
  if (const auto* event = std::get_if<MaintenanceEvent>(&message)) {
    refused = desk_->apply(*event, clock_.now());
    if (!refused || takes_back(event->kind))
      recalled_.note_said(event->kind, event->asset_id, event->header.message_id);
  }
  if (refused) {
    note_error("maintenance_event refused: " + *refused);
    log_message(LogLevel::warn, "refused", message, {{"reason", *refused}});
  }
  return refused;
}

std::optional<std::string> LayerRunner::recall_at_desk(const Message& message) {
  if (!desk_) return std::nullopt;
  if (recalled_.is_full())
    return std::to_string(RecalledAlarmActs::kMostWaiting) + " acts on alarms wait for theirs; find out who sends them";
  recalled_.add(message);
  return std::nullopt;
}

Status LayerRunner::answer_recalled() {
  recalled_.decide(*desk_, clock_.now());
  for (const RecalledAlarmActs::Decided& one : recalled_.take_decided()) {
    const auto act = act_of(one.act, clock_.now(), one.why_not.value_or(kTaken));
    if (Status recorded = act ? record(*act) : Status(); !recorded) return recorded;
    if (Status ended = journal_.end_awaiting(header_of(one.act).message_id, InputState::consumed); !ended) return ended;
  }
  return {};
}

/// An acknowledgement ends with its alarm: who has it back must know that it did.
Status LayerRunner::keep_over() {
  for (const Acknowledgement& over : desk_->take_over()) {
    keep_record(over, false);
    if (Status known = journal_.add_input(over, {}, clock_.now(), InputState::consumed); !known) return known;
  }
  return records_.empty() ? Status() : keep({.outputs = std::exchange(records_, {}), .consumed = {}});
}

/// In the batch that is being written: with what the entries follow from.
Status LayerRunner::keep_alarms() {
  if (!desk_) return {};
  if (Status answered = answer_recalled(); !answered) return answered;
  if (!desk_->changed()) return {};
  const AlarmDesk::Changes changes = desk_->take_changes();
  for (const AlarmEntry& entry : changes.kept)
    if (Status kept = journal_.keep_alarm(entry); !kept) return kept;
  for (const ServiceAlarm& alarm : changes.forgotten)
    if (Status forgotten = journal_.forget_alarm(alarm); !forgotten) return forgotten;
  if (Status kept = keep_over(); !kept) return kept;
  desk_->tell(told_at_desk_, clock_.now());
  return {};
}

/// About once a second.
Status LayerRunner::let_time_pass_at_desk() {
  if (!desk_) return {};
  ServiceStatus own;
  own.service = options_.desk->service;
  alarms_.tell(own);
  desk_->hear(own, steady_now(), clock_.now());
  desk_->look(steady_now(), clock_.now());
  desk_->tell(told_at_desk_, clock_.now());
  recalled_.decide(*desk_, clock_.now());
  return desk_->changed() || recalled_.has_decided() ? in_batch([] { return Status(); }) : Status();
}

}  // namespace sealwatch

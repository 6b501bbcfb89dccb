// The runner's part in the states of alarms (alarm_desk.hpp), where its service keeps them: what the desk hears, what
// people say to it, and its place in the journal.
#include "services/common/runtime/layer_runner.hpp"
#include "services/common/runtime/log.hpp"

namespace sealwatch {
namespace {

AlarmDesk::Steady steady_now() { return std::chrono::steady_clock::now().time_since_epoch(); }

}  // namespace

Status LayerRunner::open_desk() {
  if (!options_.desk) return {};
  auto kept = journal_.alarms();
  if (!kept) return fail(kept.error());
  desk_.emplace(*options_.desk, std::move(*kept), steady_now(), clock_.now());
  return let_time_pass_at_desk();
}

void LayerRunner::note_advice_of(const Message& output) {
  const auto said = desk_ && options_.advice_of_output ? options_.advice_of_output(output) : std::nullopt;
  if (said) desk_->stand(*said, clock_.now());
}

bool LayerRunner::is_for_desk(const Message& message) const {
  const auto* event = std::get_if<MaintenanceEvent>(&message);
  if (event != nullptr) return is_alarm_act(event->kind);
  const auto* seen = std::get_if<Acknowledgement>(&message);
  return seen != nullptr && desk_ && desk_->takes(*seen);
}

std::optional<std::string> LayerRunner::tell_desk(const Message& message) {
  if (!desk_) return std::nullopt;
  std::optional<std::string> refused;
  if (const auto* seen = std::get_if<Acknowledgement>(&message)) desk_->acknowledge(*seen, clock_.now());
  if (const auto* event = std::get_if<MaintenanceEvent>(&message)) refused = desk_->apply(*event, clock_.now());
  if (refused) {
    note_error("maintenance_event refused: " + *refused);
    log_message(LogLevel::warn, "refused", message, {{"reason", *refused}});
  }
  return refused;
}

/// In the batch that is being written: with what the entries follow from.
Status LayerRunner::keep_alarms() {
  if (!desk_ || !desk_->changed()) return {};
  const AlarmDesk::Changes changes = desk_->take_changes();
  for (const AlarmEntry& entry : changes.kept)
    if (Status kept = journal_.keep_alarm(entry); !kept) return kept;
  for (const ServiceAlarm& alarm : changes.forgotten)
    if (Status forgotten = journal_.forget_alarm(alarm); !forgotten) return forgotten;
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
  return desk_->changed() ? in_batch([] { return Status(); }) : Status();
}

}  // namespace sealwatch

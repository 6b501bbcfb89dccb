// The runner's part in setting aside messages on which a layer fails (asset_lanes.hpp says when): in the journal, in the
// heartbeat's alarms, and back again when somebody asked for it.
#include <algorithm>
#include <utility>

#include "services/common/runtime/layer_runner.hpp"
#include "services/common/runtime/log.hpp"

namespace sealwatch {
namespace {

constexpr const char* kSetAside = "set_aside";

}  // namespace

Status LayerRunner::restore_quarantine() {
  auto found = journal_.quarantine();
  if (!found) return fail(found.error());
  set_aside_ = std::move(*found);
  for (const SetAside& message : set_aside_) raise_alarm(message);
  return {};
}

void LayerRunner::raise_alarm(const SetAside& message) {
  alarms_.clear(kSetAside, message.asset_id, message.message_id);  // its reason may be another one now
  alarms_.raise({.kind = kSetAside,
                 .asset_id = message.asset_id,
                 .subject = message.message_id,
                 .pst_id = message.pst_id,
                 .text = message.reason,
                 .since_ns = message.since_ns});
}

void LayerRunner::forget_damage(const std::string& message_id) {
  const auto found = std::ranges::find(set_aside_, message_id, &SetAside::message_id);
  if (found == set_aside_.end()) return;
  alarms_.clear(kSetAside, found->asset_id, message_id);
  log_event(LogLevel::info, "concluded again", {{"message", message_id}});
  set_aside_.erase(found);
}

/// The rest of a test that was set aside goes the same way: without it, it would wait for ever.
bool LayerRunner::is_set_aside(const Message& message) const {
  const std::string& pst_id = header_of(message).pst_id;
  return !pst_id.empty() && std::ranges::any_of(set_aside_, [&](const SetAside& one) {
    return one.pst_id == pst_id && one.asset_id == asset_of(message);
  });
}

Status LayerRunner::take_failures() {
  for (const LaneResult& result : std::exchange(results_, {})) {
    if (result.failure.empty()) continue;
    log_message(LogLevel::error, result.is_message_s_fault ? "set aside" : "failed, is tried again", *result.input,
                {{"reason", result.failure}});
    if (result.is_message_s_fault)
      if (Status status = set_aside(result); !status) return status;
    if (Status status = begin_anew(result.asset_id); !status) return status;
  }
  return {};
}

Status LayerRunner::set_aside(const LaneResult& failure) {
  const Header& header = header_of(*failure.input);
  const SetAside message{.message_id = header.message_id,
                         .topic = std::string(name_of(topic_of(*failure.input))),
                         .asset_id = failure.asset_id,
                         .pst_id = header.pst_id,
                         .since_ns = clock_.now().nanoseconds,
                         .reason = failure.failure};
  if (Status status = in_batch([&] { return journal_.set_aside(message); }); !status) return status;
  lanes_.forgive(message.message_id);  // where it is tried again, it is tried as a new one
  set_aside_.push_back(message);
  raise_alarm(message);
  note_error(message.message_id + " set aside: " + message.reason);
  return {};
}

Status LayerRunner::begin_anew(const std::string& asset_id) {
  if (Status recalled = recall(asset_id); !recalled) return recalled;
  lanes_.begin_anew(asset_id);
  outputs_remembered_ -= std::exchange(remembered_[asset_id].outputs, 0);
  if (Status restored = restore_layer(asset_id); !restored) return restored;
  const auto open = journal_.open_inputs_of(asset_id);
  if (!open) return fail(open.error());
  for (const std::string& message_id : *open) lanes_.add(asset_id, message_id, nullptr);
  return {};
}

Status LayerRunner::try_again_what_was_asked() {
  if (Status counted = count_what_waits_in_vain(); !counted) return counted;
  if (set_aside_.empty()) return {};
  const auto asked = journal_.asked_again();
  if (!asked) return fail(asked.error());
  for (const std::string& message_id : *asked) {
    const auto found = std::ranges::find(set_aside_, message_id, &SetAside::message_id);
    if (found == set_aside_.end()) continue;
    const SetAside message = *found;
    if (Status released = in_batch([&] { return journal_.release(message); }); !released) return released;
    set_aside_.erase(found);
    alarms_.clear(kSetAside, message.asset_id, message_id);
    log_event(LogLevel::info, "tried again", {{"message", message_id}, {"asset", message.asset_id}});
    if (Status begun = begin_anew(message.asset_id); !begun) return begun;
  }
  return {};
}

void LayerRunner::note_set_aside_elsewhere(const ServiceStatus& other) {
  const auto& services = options_.strangers.services;
  if (!services.empty() && std::ranges::find(services, other.service) == services.end()) return;
  std::set<Journal::Test> tests;
  for (const ServiceAlarm& alarm : other.alarms)
    if (alarm.kind == kSetAside && !alarm.pst_id.empty()) tests.insert({alarm.asset_id, alarm.pst_id});
  set_aside_elsewhere_[other.service] = std::move(tests);
}

Status LayerRunner::count_what_waits_in_vain() {
  std::set<Journal::Test> tests;
  for (const auto& [service, of_service] : set_aside_elsewhere_) tests.insert(of_service.begin(), of_service.end());
  waiting_in_vain_ = 0;
  if (tests.empty()) return {};
  const auto count = journal_.open_inputs_of_tests(tests);
  if (!count) return fail(count.error());
  waiting_in_vain_ = *count;
  return {};
}

}  // namespace sealwatch

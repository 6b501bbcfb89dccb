// The runner's part in what the services keep of people's acts for each other (message/act_record.hpp). An act is said
// once, and who said it has gone home. Each service that listens to people writes what it took into a stream of its own,
// act_record, and reads those of the others. What it has itself is passed over, by the act's id; what it has not, as its
// journal was lost or is an older backup, it takes from there, as if it were said now: "fetched back".
//
//   all since a date     who takes it first names the tests that it means, in the act: fetched back, it means the same,
//                        whatever is known by then
//   acts of others       (acknowledgements, accepted models) are kept as well, for who listens to them
//   order                where the journal is new, acts come first: a replacement parts a history, which it does not do
//                        as well once later tests were concluded from. A retraction then waits for the tests that it
//                        means, and an acknowledgement for its advice, so that the answer is the last word again
//   acts on alarms       the desk's service alone takes them, and the others keep its record of them. Fetched back, each
//                        counts for what it was said of (recalled_alarm_acts.hpp)
//
// Not kept: which alarms ended unseen, as nobody said anything of them.
#include <algorithm>
#include <deque>
#include <iterator>
#include <utility>

#include "sealwatch/core/text.hpp"
#include "sealwatch/message/alarm_acts.hpp"
#include "sealwatch/message/confirmation.hpp"
#include "sealwatch/message/outside.hpp"
#include "sealwatch/message/retraction.hpp"
#include "services/common/runtime/identity.hpp"
#include "services/common/runtime/layer_runner.hpp"
#include "services/common/runtime/log.hpp"
#include "services/common/runtime/operator_acts.hpp"

namespace sealwatch {
namespace {

/// Who floods meanwhile is taken as it comes.
constexpr std::size_t kMostSaidMeanwhile = 1000;
constexpr Topic kSaidByPeople[] = {Topic::maintenance_event, Topic::model_acceptance, Topic::acknowledgement};

/// Beside a record of an act that was ahead there is another, once what it means is known.
ActRecord record_of(const Message& act, std::string_view service, bool is_ahead) {
  ActRecord record;
  record.asset_id = asset_of(act);
  record.header.message_id =
      "act_record/" + std::string(service) + (is_ahead ? "/ahead/" : "/") + content_hash(header_of(act).message_id);
  record.header.producer = service;
  record.is_ahead = is_ahead;
  if (const auto* event = std::get_if<MaintenanceEvent>(&act)) record.events = {*event};
  if (const auto* acceptance = std::get_if<ModelAcceptance>(&act)) record.acceptances = {*acceptance};
  if (const auto* seen = std::get_if<Acknowledgement>(&act)) record.acknowledgements = {*seen};
  return record;
}

std::optional<Message> act_in(const ActRecord& record) {
  if (!record.events.empty()) return record.events.front();
  if (!record.acceptances.empty()) return record.acceptances.front();
  if (!record.acknowledgements.empty()) return record.acknowledgements.front();
  return std::nullopt;
}

/// Whether its journal is damaged there, or this version cannot read it: a true one that will come again.
bool is_lost_on_the_way(const ActRecord& record) {
  const std::string& id = record.header.message_id;
  return id.starts_with(kDamagedMessage) || id.starts_with(kUnreadableMessage);
}

/// An act, under the id that any service gives to its record of it: under another it would keep a true record out.
bool is_record_of_an_act(const ActRecord& record) {
  const auto act = act_in(record);
  return act && asset_of(*act) == record.asset_id && !header_of(*act).message_id.empty() &&
         record.header.message_id == record_of(*act, record.header.producer, record.is_ahead).header.message_id;
}

/// As it came, as far as the audit trail tells it; nothing for what is not known any more.
std::optional<Message> act_of_trail(const OperatorAct& act) {
  if (act.kind == name_of(Topic::acknowledgement)) {
    if (!act.subject.starts_with("acknowledgement/") || std::ranges::count(act.subject, '/') < 2) return std::nullopt;
    Acknowledgement seen;
    seen.asset_id = act.asset_id;
    seen.header.message_id = act.subject;
    seen.header.event_time_known = true;
    seen.header.event_time_ns = act.at.nanoseconds;
    seen.advisory_id = act.subject.substr(act.subject.find('/') + 1);
    seen.advisory_id.resize(seen.advisory_id.rfind('/'));
    seen.acknowledged_by = act.who;
    seen.remark = act.text;
    return seen;
  }
  MaintenanceEvent event;
  event.asset_id = act.asset_id;
  event.header.message_id = act.subject;
  event.header.event_time_known = true;
  event.header.event_time_ns = time_of_replacement(act.subject).value_or(act.at).nanoseconds;
  event.kind = act.kind;
  event.reported_by = act.who;
  event.remark = act.text;
  const bool has_time = !is_replacement(event) || time_of_replacement(act.subject);
  const bool is_confirmation = act.kind == kActConfirmed || act.kind == kActRejected;
  const bool is_known =
      is_replacement(event) || is_retraction_kind(act.kind) || is_confirmation || is_alarm_act(act.kind);
  return has_time && is_known ? std::optional<Message>(event) : std::nullopt;
}

}  // namespace

bool LayerRunner::keeps_acts() const {
  return std::ranges::any_of(kind_->inputs(), [](Topic topic) { return std::ranges::count(kSaidByPeople, topic) > 0; });
}

bool LayerRunner::is_listened_to(const Message& act) const {
  return std::ranges::find(kind_->inputs(), topic_of(act)) != kind_->inputs().end();
}

/// Only a service knows what is known; what a sender says of it does not count.
void LayerRunner::name_tests(Message& act) const {
  auto* const event = std::get_if<MaintenanceEvent>(&act);
  if (event == nullptr) return;
  event->tests_known = false;
  event->test_ids.clear();
  if (event->kind != kTestsRetracted) return;
  const auto retraction = retraction_of(*event);
  if (!retraction || !retraction->since) return;
  event->test_ids = admission_.tests_meant(event->asset_id, *retraction);
  event->tests_known = true;
}

void LayerRunner::keep_record(const Message& act, bool is_ahead) {
  if (std::ranges::count(kSaidByPeople, topic_of(act)) == 0) return;
  Message kept = without_stamps(act);
  // Of which occurrence of an alarm it was said, its time tells.
  if (auto* const seen = std::get_if<Acknowledgement>(&kept); seen && !seen->header.event_time_known) {
    seen->header.event_time_known = true;
    seen->header.event_time_ns = clock_.now().nanoseconds;
  }
  records_.emplace_back(record_of(kept, kind_->name(), is_ahead));
}

bool LayerRunner::is_to_be_kept(const Message& act, bool is_for_desk) const {
  const auto* const seen = std::get_if<Acknowledgement>(&act);
  return !is_for_desk || (desk_ && (seen == nullptr || !is_advisory_id(seen->advisory_id)));
}

/// What an earlier version took stands in the audit trail, and an accepted model among the inputs that are kept.
Status LayerRunner::record_earlier_acts() {
  if (!keeps_acts() || journal_.written().contains(Topic::act_record)) return {};
  const auto acts = journal_.acts();
  if (!acts) return fail(acts.error());
  for (const AuditEntry& entry : *acts) {
    if (!is_taken(entry.act.outcome)) continue;
    auto kept = journal_.input(entry.act.subject);
    if (!kept) return fail(kept.error());
    auto act = *kept ? std::move(*kept) : act_of_trail(entry.act);
    if (!act) continue;
    if (auto* const event = std::get_if<MaintenanceEvent>(&*act))
      if (Status named = name_tests_known(*event, entry.act.at); !named) return named;
    keep_record(*act, false);
  }
  if (records_.empty()) return {};
  return in_batch([this] { return keep({.outputs = std::exchange(records_, {}), .consumed = {}}); },
                  Survives::power_cuts);
}

Status LayerRunner::name_tests_known(MaintenanceEvent& event, UtcTime at) {
  const auto retraction = retraction_of(event);
  if (!retraction || !retraction->since || event.tests_known) return {};
  std::set<std::string> meant;
  Status read = journal_.for_each_output_of(
      event.asset_id,
      [&](const Message& output, const Journal::Place& place) {
        const Header& header = header_of(output);
        const bool is_of_test = !header.pst_id.empty() && header.event_time_known;
        if (is_of_test && place.concluded <= at && UtcTime{header.event_time_ns} >= *retraction->since)
          meant.insert(header.pst_id);
        return Status();
      },
      [this](const Message& last_of_test) { return kind_->tells_all(last_of_test); });
  event.tests_known = true;
  event.test_ids.assign(meant.begin(), meant.end());
  return read;
}

Status LayerRunner::take_record(Message message, const StreamPosition& stream) {
  const ActRecord record = std::get<ActRecord>(message);
  const auto refused = admission_.refusal(message, clock_.now());
  if (refused) {
    note_error("act_record refused: " + *refused);
    log_message(LogLevel::warn, "refused", message, {{"reason", *refused}});
  }
  taken_ids_[record.header.message_id] = taken_.size();
  taken_.push_back({std::make_shared<const Message>(without_stamps(std::move(message))), stream, InputState::consumed});
  const bool is_over = record.is_ahead && has_waited_too_long(time_said(&record));
  const auto act = refused || is_over || stream.sequence == 0 ? std::nullopt : act_in(record);
  if (!act || asset_of(*act) != record.asset_id || header_of(*act).message_id.empty()) return {};
  if (desk_ || !is_for_desk(*act, true)) return take(without_stamps(*act), &record);
  // It may have heard the act itself, but not whether the desk took it: this says so.
  if (!admission_.refusal_of_asset(*act) && !refusal_of(*act, &record)) keep_record(*act, false);
  return {};
}

/// Of what no service writes the journal keeps no id: whoever sends it sends as much as can be.
bool LayerRunner::is_false_record(const Message& message) {
  const auto* const record = std::get_if<ActRecord>(&message);
  if (record == nullptr || is_lost_on_the_way(*record)) return false;
  const auto refused = is_record_of_an_act(*record) ? admission_.refusal(message, clock_.now())
                                                    : "its id, or its asset, is not that of a record of its act";
  if (!refused) return false;
  const std::string subject = "act_record/" + record->header.writer_id;
  note_strangers({{subject.substr(0, kLongestId), "it writes records of acts that no service writes: " + *refused}});
  return true;
}

void LayerRunner::put_in_line(Message message) {
  if (topic_of(message) == Topic::act_record)
    told_records_.emplace_back(std::move(message), std::chrono::steady_clock::now());
  else
    ready_.push_back(std::move(message));
}

/// Its place in the stream is not kept until then: after a kill it is read again.
Status LayerRunner::release_records() {
  for (; !told_records_.empty(); told_records_.pop_front()) {
    auto& [record, since] = told_records_.front();
    const bool has_waited = std::chrono::steady_clock::now() - since >= options_.records_wait;
    if (!waits_for_acts_ && !has_waited) {
      const auto waits = waits_for_its_act(record);
      if (!waits) return fail(waits.error());
      if (*waits) return {};
    }
    ready_.push_back(std::move(record));
  }
  return {};
}

Result<bool> LayerRunner::waits_for_its_act(const Message& record) {
  const auto act = act_in(std::get<ActRecord>(record));
  if (!act || !is_listened_to(*act)) return false;
  const auto known = journal_.has_input(header_of(*act).message_id);
  if (!known) return fail(known.error());
  return !*known;
}

/// Who said "all since a date" and is still there says it again to whoever comes: taken now, it would mean what is known
/// here. Of what services number nothing is kept: they send it again.
bool LayerRunner::waits_for_acts(const Message& message) {
  const Topic topic = topic_of(message);
  if (!waits_for_acts_ || topic == Topic::act_record) return false;
  if (is_of_a_service(name_of(topic))) return is_numbered(message);
  if (std::ranges::count(kSaidByPeople, topic) == 0 || said_meanwhile_.size() >= kMostSaidMeanwhile) return false;
  said_meanwhile_.push_back(message);
  return true;
}

void LayerRunner::look_whether_acts_are_here() {
  if (!waits_for_acts_) return;
  const bool are_here =
      all_heard() && !reader_->is_behind_on(name_of(Topic::act_record)) && ready_.empty() && told_records_.empty();
  const bool is_over = std::chrono::steady_clock::now() - started_ >= options_.longest_without_acts;
  if (!are_here && !is_over) return;
  waits_for_acts_ = false;
  std::ranges::move(std::exchange(said_meanwhile_, {}), std::back_inserter(ready_));
  log_event(LogLevel::info, are_here ? "what people said is here" : "others are not heard, what they keep comes later",
            {{"acts", std::to_string(last_act_.sequence)}});
}

void LayerRunner::note_standing(const Message& output) {
  const auto* const advisory = std::get_if<Advisory>(&output);
  if (advisory == nullptr || advisory->state == AdvisoryState::superseded) return;
  standing_[advisory->asset_id] = advisory->advisory_id;
  heard_of_.insert(advisory->asset_id);
}

/// A retraction stands behind the tests that it means: the answer to it then is the last word, as it was. One that may
/// never come, set aside or refused here, keeps it no longer than there is something to wait for.
bool LayerRunner::is_its_turn(const Message& act) const {
  const std::string asset_id = asset_of(act);
  if (is_of_later_advice(act)) return false;
  const auto retraction = retraction_of(asset_id, header_of(act).message_id);
  if (!retraction || admission_.knows_all_of(asset_id, *retraction)) return true;
  return is_quiet(asset_id) && admission_.may_be_given(asset_id, *retraction);
}

bool LayerRunner::is_quiet(const std::string& asset_id) const {
  const bool is_told_of_all =
      all_heard() || std::chrono::steady_clock::now() - started_ >= options_.longest_without_acts;
  return is_told_of_all && !waits_for_acts_ && ready_.empty() && told_records_.empty() &&
         !reader_->is_behind(asset_id) && !lanes_.is_receiving(asset_id);
}

/// Of an asset with acts that were fetched back, one message after another is concluded from: an act is given behind the
/// last test that it means, and before those that came after it.
Status LayerRunner::take_all_in_turn() {
  std::deque<Message> later;
  std::set<std::string> waiting;
  for (; !ready_.empty(); ready_.pop_front()) {
    Message& next = ready_.front();
    const std::string asset_id = asset_of(next);
    const bool waits =
        waiting.contains(asset_id) || (awaits_quiet_.contains(asset_id) && lanes_.is_receiving(asset_id));
    if (waits) {
      waiting.insert(asset_id);
      later.push_back(std::move(next));
    } else if (Status taken = take(std::move(next)); !taken) {
      return taken;
    }
  }
  ready_ = std::move(later);
  return {};
}

/// About once a second.
void LayerRunner::look_whether_assets_are_quiet() {
  std::erase_if(awaits_quiet_, [this](const std::string& asset_id) {
    if (!acts_ahead_.contains(asset_id)) return true;
    if (!is_quiet(asset_id)) return false;
    heard_of_.insert(asset_id);
    return true;
  });
}

/// An acknowledgement of other advice than what stands changes nothing, and is said to have changed nothing.
bool LayerRunner::is_of_later_advice(const Message& act) const {
  const auto* const seen = std::get_if<Acknowledgement>(&act);
  if (seen == nullptr) return false;
  const auto stands = standing_.find(seen->asset_id);
  return stands == standing_.end() || stands->second != seen->advisory_id;
}

}  // namespace sealwatch

// The runner's part in what people say: each act stands in the audit trail, and one that waits for a second person is
// kept from the layer until another one confirms it (message/confirmation.hpp).
#include <algorithm>
#include <cctype>

#include "sealwatch/core/visible_text.hpp"
#include "sealwatch/message/confirmation.hpp"
#include "services/common/runtime/layer_runner.hpp"
#include "services/common/runtime/log.hpp"
#include "services/common/runtime/operator_acts.hpp"

namespace sealwatch {
namespace {

constexpr const char* kAwaitsConfirmation = "awaits_confirmation";
constexpr std::ptrdiff_t kMostAwaiting = 8;  ///< of an asset
/// Of an asset: who sends more floods. Those that a neighbour took are not counted: they come to mean something here.
constexpr std::ptrdiff_t kMostAhead = 8;
constexpr std::size_t kHashLength = 64;
/// Of a second: who invents records invents many.
constexpr std::size_t kMostNewAnchors = 16;

std::string who_said(const Message& message) {
  const auto act = act_of(message, {}, {});
  return act ? act->who : std::string();
}

/// "J. Silva " and "j. silva" are one person, whatever kind of space it is.
std::string plain(const std::string& who) {
  std::string name = without_blanks(who);
  for (char& letter : name) letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  return name;
}

/// Who has DDS Security knows that nobody else speaks in the other's name.
constexpr const char* kOrForged = "; or somebody else sends heartbeats in its name";

std::string journal_lost(const std::string& other) {
  return "the journal was lost, as " + other +
         " knows of one before it, and is made again from the neighbours' messages" + kOrForged;
}

/// In a heartbeat and in the journal: StreamPosition of this topic, with the service's name in the place of the writer.
std::string topic_of_name(std::string_view service) { return "service_status/" + std::string(service); }

std::string journal_set_back(const std::string& other) {
  return "the journal is older than what " + other +
         " has read of it: a restored copy, or its end was cut off; what is missing is made again from the "
         "neighbours' messages" +
         kOrForged;
}

/// What `other`, of an earlier version, has taken, and keeps for nobody.
std::string what_people_said(const std::string& other) {
  return "what people said, of which " + other +
         " has a record: retract, accept and acknowledge again what sealwatch audit shows to be in force";
}

/// Nobody sends them again.
std::string samples_of_earlier_tests(const std::string& other) {
  return "the samples of earlier tests, of which " + other + " has a record: restore a backup";
}

constexpr const char* kEndedUnseen = "alarms that ended before anybody had acknowledged them: see the logs";

/// Whether it rejects what it speaks of.
bool rejects(const Message& message) {
  const auto* event = std::get_if<MaintenanceEvent>(&message);
  return event != nullptr && event->kind == kActRejected;
}

/// The act that it confirms or rejects.
std::optional<std::string> act_confirmed_by(const Message& message) {
  const auto* event = std::get_if<MaintenanceEvent>(&message);
  if (event == nullptr || (event->kind != kActConfirmed && event->kind != kActRejected)) return std::nullopt;
  return confirmed_act(event->asset_id, event->header.message_id);
}

}  // namespace

Status LayerRunner::restore_awaiting() {
  const auto waiting = journal_.awaiting();
  if (!waiting) return fail(waiting.error());
  for (const Journal::Awaiting& one : *waiting) await(std::make_shared<const Message>(one.message), one.received);
  return restore_ahead();
}

Status LayerRunner::restore_ahead() {
  const auto ahead = journal_.acts_ahead();
  if (!ahead) return fail(ahead.error());
  for (const Journal::Ahead& one : *ahead) {
    ++acts_ahead_[one.asset_id];
    awaits_quiet_.insert(one.asset_id);
    said_ahead_[one.message_id] = {one.asset_id, one.received};
  }
  if (said_ahead_.empty()) return {};
  const auto acts = journal_.acts();
  if (!acts) return fail(acts.error());
  for (const AuditEntry& entry : *acts)
    if (entry.act.outcome.starts_with(std::string(kAhead) + kFetchedBack)) said_ahead_.erase(entry.act.subject);
  return {};
}

void LayerRunner::await(std::shared_ptr<const Message> act, UtcTime since) {
  const Header& header = header_of(*act);
  const auto told = act_of(*act, clock_.now(), {});
  // Of a lost journal all that nobody confirmed in time comes back, for as long.
  if (waiting_acts(asset_of(*act)) < kMostAwaiting)
    alarms_.raise({.kind = kAwaitsConfirmation,
                   .asset_id = asset_of(*act),
                   .subject = header.message_id,
                   .pst_id = {},
                   .text = told->kind + " by " + told->who + " counts once another person confirms it",
                   .since_ns = since.nanoseconds});
  awaiting_[header.message_id] = {std::move(act), since};
}

/// Why a confirmation confirms nothing; none for all other messages.
std::optional<std::string> LayerRunner::refusal_of_confirmation(const Message& message, const ActRecord* record) const {
  const auto act_id = act_confirmed_by(message);
  if (!act_id) return std::nullopt;
  const bool is_read_here = !act_id->starts_with("model_acceptance/") ||
                            std::ranges::find(kind_->inputs(), Topic::model_acceptance) != kind_->inputs().end();
  if (!is_read_here) return std::nullopt;
  const auto waiting = awaiting_.find(*act_id);
  if (waiting == awaiting_.end() || asset_of(*waiting->second.act) != asset_of(message) ||
      (record == nullptr && has_waited_too_long(waiting->second.since)))
    return "nothing of the id '" + *act_id + "' waits for a confirmation";
  if (plain(who_said(message)).empty()) return "it does not say who; give a name";
  if (!rejects(message) && plain(who_said(message)) == plain(who_said(*waiting->second.act)))
    return who_said(message) + " said so in the first place; it takes another person to confirm it";
  return std::nullopt;
}

/// Somebody stands for each act: a record of what nobody did says nothing.
std::optional<std::string> LayerRunner::refusal_of_nameless(const Message& message) {
  if (!is_an_act(message) || !plain(who_said(message)).empty()) return std::nullopt;
  return "it does not say who; give a name";
}

bool LayerRunner::keeps_refused(const Message& act, const std::string& refused) {
  if (refused_acts_.admits(std::chrono::steady_clock::now())) return true;
  if (!refused_acts_.is_to_be_told()) return false;
  const std::string count = std::to_string(refused_acts_.left_out());
  acts_.push_back({.at = clock_.now(),
                   .kind = kRefusedActs,
                   .asset_id = asset_of(act),
                   .who = {},
                   .subject = {},
                   .text = count + " more within a day, left out here",
                   .outcome = refused});
  return false;
}

bool LayerRunner::waits_for_second(const Message& message) const {
  return options_.acts_confirmed_by_second && may_lower_an_advisory(message);
}

std::ptrdiff_t LayerRunner::waiting_acts(const std::string& asset_id) const {
  return std::ranges::count_if(awaiting_, [&](const auto& one) { return asset_of(*one.second.act) == asset_id; });
}

/// Each waits in the journal, with an alarm of its own, and nothing is known of what it will mean.
std::optional<std::string> LayerRunner::refusal_of_waiting(const Message& message) const {
  if (!waits_for_second(message)) return std::nullopt;
  const std::string asset_id = asset_of(message);
  const std::ptrdiff_t of_asset = waiting_acts(asset_id);
  if (of_asset < kMostAwaiting) return std::nullopt;
  return std::to_string(of_asset) + " acts of asset " + asset_id +
         " wait for a second person already; confirm or reject those, and say it again";
}

std::optional<std::string> LayerRunner::refusal_of_ahead(const Message& message) const {
  if (!admission_.is_ahead(message)) return std::nullopt;
  const std::string asset_id = asset_of(message);
  const auto ahead =
      std::ranges::count_if(said_ahead_, [&](const auto& one) { return one.second.asset_id == asset_id; });
  if (ahead < kMostAhead) return std::nullopt;
  return "it means no test, retraction or replacement that is known, and " + std::to_string(kMostAhead) +
         " such ones of asset " + asset_id + " wait already; find out who sends them";
}

bool LayerRunner::may_be_fetched_later(const Message& message) const {
  return admission_.refusal_of_idle(message) || refusal_of_ahead(message) || refusal_of_many(message);
}

std::string LayerRunner::outcome_of_taken(const Message& message) {
  const auto* const accepted = std::get_if<ModelAcceptance>(&message);
  const bool hears_of_models = std::ranges::find(kind_->inputs(), Topic::model_discrepancy) != kind_->inputs().end();
  if (accepted == nullptr || accepted->revoked || !hears_of_models) return kTaken;
  const std::string& named = accepted->discrepancy_id;
  return taken_ids_.contains(named) || journal_.has_input(named).value_or(true) ? kTaken : kTakenAndWaits;
}

InputState LayerRunner::note_act(const Message& message, const std::optional<std::string>& refused, InputState state,
                                 const ActRecord* record) {
  const bool waits = !refused && waits_for_second(message);
  const bool waits_at_desk = state == InputState::ahead;
  const bool is_fetched_early = record != nullptr && !waits_at_desk && !is_its_turn(message);
  const bool is_ahead = waits_at_desk || (!refused && !waits && (admission_.is_ahead(message) || is_fetched_early));
  if (is_ahead && is_fetched_early) awaits_quiet_.insert(asset_of(message));
  std::string outcome = refused ? *refused : waits ? kWaits : is_ahead ? kAhead : outcome_of_taken(message);
  if (record != nullptr)
    outcome += (is_ahead && record->is_ahead ? kAsElsewhere : kFetchedBack) + visible(record->header.producer);
  if (auto act = act_of(message, clock_.now(), outcome)) acts_.push_back(std::move(*act));
  if (refused || act_confirmed_by(message)) return InputState::consumed;
  return waits ? InputState::awaiting : is_ahead ? InputState::ahead : state;
}

Status LayerRunner::give_acts_ahead() {
  for (const std::string& asset_id : std::exchange(heard_of_, {}))
    if (acts_ahead_.contains(asset_id))
      if (Status given = give_acts_ahead(asset_id); !given) return given;
  return {};
}

/// A service that is behind hears of a retraction before the test: refused here alone, the test would count.
Status LayerRunner::give_acts_ahead(const std::string& asset_id) {
  const auto ids = journal_.acts_ahead(asset_id);
  if (!ids) return fail(ids.error());
  for (const std::string& act_id : *ids) {
    const auto retraction = retraction_of(asset_id, act_id);
    if (retraction && !admission_.may_be_given(asset_id, *retraction)) continue;
    auto act = journal_.input(act_id);
    if (!act) return fail(act.error());
    if (!*act || is_for_desk(**act, true)) continue;
    if (!is_its_turn(**act)) {
      awaits_quiet_.insert(asset_id);
      continue;
    }
    if (auto taken = act_of(**act, clock_.now(), outcome_of_taken(**act))) acts_.push_back(std::move(*taken));
    keep_record(**act, false);
    no_longer_awaiting_[act_id] = InputState::open;
    said_ahead_.erase(act_id);
    if (--acts_ahead_[asset_id] == 0) acts_ahead_.erase(asset_id);
    give(std::make_shared<const Message>(std::move(**act)));
    heard_of_.insert(asset_id);  // what takes it back may wait for it
  }
  return {};
}

void LayerRunner::give(const std::shared_ptr<const Message>& act) {
  admission_.note(*act, false);
  look_for_future_test(asset_of(*act));
  lanes_.add(asset_of(*act), header_of(*act).message_id, act);
}

void LayerRunner::confirm(const Message& message) {
  const auto act_id = act_confirmed_by(message);
  const auto waiting = act_id ? awaiting_.find(*act_id) : awaiting_.end();
  if (waiting == awaiting_.end()) return;
  const std::shared_ptr<const Message> act = waiting->second.act;
  awaiting_.erase(waiting);
  alarms_.clear(kAwaitsConfirmation, asset_of(*act), *act_id);
  if (const auto taken = taken_ids_.find(*act_id); taken != taken_ids_.end())
    taken_[taken->second].state = rejects(message) ? InputState::consumed : InputState::open;  // both in one batch
  else
    no_longer_awaiting_[*act_id] = rejects(message) ? InputState::consumed : InputState::open;
  if (!rejects(message)) give(act);
}

std::map<std::string, std::vector<LayerRunner::PastAct>> LayerRunner::past_retractions(
    const std::vector<AuditEntry>& acts) {
  std::map<std::string, std::vector<PastAct>> past;
  for (const AuditEntry& entry : acts) {
    const OperatorAct& act = entry.act;
    if (!is_taken(act.outcome)) continue;
    const auto confirmed =
        act.kind == kActConfirmed ? confirmed_act(act.asset_id, act.subject) : std::optional<std::string>();
    past[act.asset_id].push_back({act.at, confirmed.value_or(act.subject)});
  }
  return past;
}

Status LayerRunner::record(const OperatorAct& act) {
  const auto entry = journal_.record(act);
  if (!entry) return fail(entry.error());
  log_event(LogLevel::info, "act recorded",
            {{"kind", act.kind},
             {"asset", act.asset_id},
             {"by", act.who},
             {"subject", act.subject},
             {"outcome", act.outcome},
             {"entry", std::to_string(entry->sequence)},
             {"hash", entry->hash}});
  return {};
}

Status LayerRunner::tell(const Refusal& refused) {
  note_error(std::string(name_of(topic_of(refused.input))) + " refused: " + refused.reason);
  log_message(LogLevel::warn, "refused", refused.input, {{"reason", refused.reason}});
  const auto act = act_of(refused.input, clock_.now(), refused.reason);
  return act ? record(*act) : Status();
}

/// A stranger may tell anything; but of whom DDS Security lets nobody else speak, only that service does. A record is
/// older than the journal where it is not empty when it is first heard of, ever: later both grow.
void LayerRunner::hear_of_acts(const ServiceStatus& status) {
  const auto& services = options_.strangers.services;
  const bool is_known = services.empty() || std::ranges::find(services, status.service) != services.end();
  if (!is_known || status.service == kind_->name()) return;
  const bool is_first = first_heard_.insert(status.service).second && compared_.insert(status.service).second;
  const auto told =
      std::ranges::find_if(status.written, [](const StreamPosition& one) { return one.topic == kActsTopic; });
  if (told == status.written.end() || told->writer_id.size() != kHashLength) {
    if (is_first) keep_anchor({status.service, 0, audit_begin(status.service)});
    return;
  }
  if (is_first && told->sequence > 0 && last_act_.sequence == 0) note_older_acts(status);
  const AuditAnchor heard{status.service, static_cast<std::int64_t>(told->sequence), told->writer_id};
  if (std::exchange(heard_acts_[status.service], heard) != heard) keep_anchor(heard);
}

void LayerRunner::keep_anchor(const AuditAnchor& heard) {
  if (new_anchors_.size() < kMostNewAnchors) new_anchors_.push_back(heard);
}

/// The first name stays, whatever comes later: the service that compares it may go on under another one already.
void LayerRunner::keep_name(const ServiceStatus& status) {
  const auto& services = options_.strangers.services;
  if (std::ranges::find(services, status.service) == services.end() || status.service == kind_->name()) return;
  if (!strangers_.knows(status.writer_id)) return;
  if (std::ranges::all_of(status.written, [](const StreamPosition& one) { return one.sequence == 0; })) return;
  const std::string topic = topic_of_name(status.service);
  if (first_names_.try_emplace(topic, status.writer_id).second) new_names_.insert(topic);
}

bool LayerRunner::restore_name(const StreamPosition& known) {
  if (!known.topic.starts_with(topic_of_name({}))) return false;
  first_names_[known.topic] = known.writer_id;
  return true;
}

void LayerRunner::note_older_acts(const ServiceStatus& status) {
  has_older_acts_ = status.service;
  const bool are_kept =
      std::ranges::find(status.written, name_of(Topic::act_record), &StreamPosition::topic) != status.written.end();
  if (!are_kept) has_unrecorded_acts_ = status.service;
}

bool LayerRunner::reads_samples() const {
  return std::ranges::find(kind_->inputs(), Topic::raw_samples) != kind_->inputs().end();
}

/// Others remember who this service was, and how far they read: in a journal before this one, or further than it goes.
void LayerRunner::hear_of_own_outputs(const ServiceStatus& status) {
  if (!strangers_.knows(status.writer_id)) return;
  bool is_reader = false, is_beyond = false;
  for (const StreamPosition& read : status.received) {
    if (is_new_ && read.topic == topic_of_name(kind_->name()) && read.writer_id != journal_.writer_id())
      has_read_more_ = status.service;
    const auto topic = value_of<Topic>(read.topic);
    if (!topic || read.sequence == 0) continue;
    const bool is_own_kind = std::ranges::find(kind_->outputs(), *topic) != kind_->outputs().end();
    if (read.writer_id == journal_.writer_id()) {
      const auto found = journal_.written().find(*topic);
      const std::uint64_t written = found == journal_.written().end() ? 0 : found->second;
      is_reader = true;
      if (written >= read.sequence) continue;
      if (has_read_own_.contains(status.service)) return tell_of_false_position(status, read, written);
      is_beyond = true;
    } else if (is_new_ && is_own_kind) {
      has_read_more_ = status.service;
    }
  }
  if (is_beyond) set_back_before_ = status.service;
  if (is_reader && !is_beyond) has_read_own_.insert(status.service);
}

/// No journal is set back while its service runs (Journal::is_in_place).
void LayerRunner::tell_of_false_position(const ServiceStatus& status, const StreamPosition& read,
                                         std::uint64_t written) {
  note_strangers({{"heartbeat of " + status.service,
                   "it says that " + status.service + " has read number " + std::to_string(read.sequence) + " of " +
                       read.topic + ", of which this service has written " + std::to_string(written) +
                       ": its heartbeat is forged, or its journal is damaged"}});
}

/// Before the first heartbeat, which others compare with their own record where that is new.
Status LayerRunner::look_at_own_acts() {
  auto last = journal_.last_act();
  if (!last) return fail(last.error());
  last_act_ = std::move(*last);
  return {};
}

/// What others record from then on is not older than the own journal. A service that is down may have an older record.
bool LayerRunner::all_heard() const {
  const auto& services = options_.strangers.services;
  return !services.empty() && std::ranges::all_of(services, [this](const std::string& service) {
    return service == kind_->name() || first_heard_.contains(service);
  });
}

/// What a new journal lacks that its neighbours have no record of; nothing where all of it can be had back.
std::optional<std::string> LayerRunner::lost_for_ever() const {
  std::vector<std::string> lost;
  const std::string& knows_of_it = has_read_more_.empty() ? has_older_acts_ : has_read_more_;
  if (reads_samples() && !knows_of_it.empty()) lost.push_back(samples_of_earlier_tests(knows_of_it));
  if (keeps_acts() && !has_unrecorded_acts_.empty()) lost.push_back(what_people_said(has_unrecorded_acts_));
  if (desk_ && !knows_of_it.empty()) lost.emplace_back(kEndedUnseen);
  if (lost.empty()) return std::nullopt;
  std::string all = lost.front();
  for (std::size_t k = 1; k < lost.size(); ++k) all += "; and for " + lost[k];
  return all;
}

/// The neighbours' messages make the conclusions again, and their records have what people said. What nobody can give
/// back would be missing in this service alone, and nobody would know.
Status LayerRunner::compare_acts() {
  if (waits_for_acts_) return {};  // a restart before all acts are here waits for them again
  if (set_back_before_ && !tells_of_set_back_) {
    tells_of_set_back_ = true;
    if (Status told = tell_of_journal(journal_set_back(*set_back_before_), samples_lost_with(*set_back_before_)); !told)
      return told;
  }
  if (!is_new_) return {};
  const auto what = lost_for_ever();
  const bool is_remade = what || !has_read_more_.empty();
  // A service that never runs keeps no loss secret that another knows of.
  const bool is_heard =
      all_heard() || (is_remade && std::chrono::steady_clock::now() - started_ >= options_.longest_without_acts);
  if (!what && !is_heard) return {};
  const std::string& other = !has_read_more_.empty()    ? has_read_more_
                             : !has_older_acts_.empty() ? has_older_acts_
                                                        : has_unrecorded_acts_;
  // Told first: who is killed between the two tells it again.
  if (Status told = is_remade ? tell_of_journal(journal_lost(other), what) : Status(); !told) return told;
  is_new_ = false;
  return in_batch([&] { return journal_.no_longer_new(); }, Survives::power_cuts);
}

std::optional<std::string> LayerRunner::samples_lost_with(const std::string& other) const {
  return reads_samples() ? std::optional(samples_of_earlier_tests(other)) : std::nullopt;
}

/// Where the journal itself noticed already (store/database.cpp), only what cannot be made again is added.
Status LayerRunner::tell_of_journal(const std::string& reason, const std::optional<std::string>& lost) {
  SetAside told{.message_id = "journal/" + std::string(kind_->name()),
                .topic = {},
                .asset_id = {},
                .pst_id = {},
                .since_ns = clock_.now().nanoseconds,
                .reason = reason};
  const auto known = std::ranges::find(set_aside_, told.message_id, &SetAside::message_id);
  if (known != set_aside_.end()) {
    if (!lost || known->reason.find(*lost) != std::string::npos) return {};
    told = *known;
  }
  if (lost) told.reason += ", but for " + *lost;
  if (Status kept = in_batch([&] { return journal_.set_aside(told); }, Survives::power_cuts); !kept) return kept;
  if (known != set_aside_.end())
    *known = told;
  else
    set_aside_.push_back(told);
  raise_alarm(told);
  note_error(told.reason);
  log_event(LogLevel::error, "journal lost", {{"error", told.reason}});
  return {};
}

/// About once a second. Also those who ask for something in a journal of their own (sealwatch quarantine) write there.
Status LayerRunner::note_acts() {
  if (Status looked = look_at_own_acts(); !looked) return looked;
  if (Status compared = compare_acts(); !compared) return compared;
  if (new_anchors_.empty() && new_names_.empty()) return {};
  return in_batch([this] {
    for (const AuditAnchor& heard : std::exchange(new_anchors_, {}))
      if (Status kept = journal_.keep_anchor(heard); !kept) return kept;
    for (const std::string& topic : std::exchange(new_names_, {}))
      if (Status kept = journal_.set_position({topic, first_names_[topic], 1}); !kept) return kept;
    return Status();
  });
}

/// Their last hash stands in the log as well: whoever changes the journal must change that too.
Status LayerRunner::record_acts() {
  for (const OperatorAct& act : std::exchange(acts_, {}))
    if (Status recorded = record(act); !recorded) return recorded;
  for (const auto& [act_id, state] : std::exchange(no_longer_awaiting_, {}))
    if (Status ended = journal_.end_awaiting(act_id, state); !ended) return ended;
  for (const std::string& act_id : std::exchange(given_up_, {}))
    if (Status forgotten = journal_.forget_awaiting(act_id); !forgotten) return forgotten;
  return {};
}

}  // namespace sealwatch

#include "services/common/runtime/layer_runner.hpp"

#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <thread>

#include "sealwatch/message/id_part.hpp"
#include "sealwatch/message/outside.hpp"
#include "services/common/runtime/confirmed_positions.hpp"
#include "services/common/runtime/identity.hpp"
#include "services/common/runtime/log.hpp"
#include "services/common/runtime/operator_acts.hpp"
#include "services/common/runtime/stream_window.hpp"

namespace sealwatch {
namespace {

using std::chrono::steady_clock;

/// Items taken from the bus at once.
constexpr std::size_t kBatch = 64;
constexpr std::chrono::milliseconds kSecond{1000};
/// How often a trial in another process is looked at.
constexpr std::chrono::milliseconds kTrialLook{20};
/// A service beats once a second: one that is not heard for so long holds up nothing.
constexpr std::chrono::seconds kReaderIsGone{10};

}  // namespace

LayerRunner::LayerRunner(const LayerMaker& make_layer, Bus& bus, Bus& heartbeat_bus, Journal& journal,
                         const Clock& clock, RunnerOptions options)
    : kind_(make_layer({})),
      bus_(bus),
      heartbeat_bus_(heartbeat_bus),
      journal_(journal),
      clock_(clock),
      options_(std::move(options)),
      resends_(options_.resent_at_once),
      admission_(options_.commissioned, {.names = {options_.assets.begin(), options_.assets.end()},
                                         .refuses_others = options_.refuses_unknown_assets}),
      strangers_(options_.strangers),
      retention_(options_.retention),
      lanes_(
          make_layer, [this](const std::string& message_id) { return input(message_id); }, [&bus] { bus.wake(); },
          options_.lanes) {
  inputs_.assign(kind_->inputs().begin(), kind_->inputs().end());
  outputs_.assign(kind_->outputs().begin(), kind_->outputs().end());
  if (!keeps_acts()) return;
  inputs_.push_back(Topic::act_record);
  outputs_.push_back(Topic::act_record);
}

Status LayerRunner::start() {
  // While this process joined, DDS refused whoever came before there was anything to compare them with.
  if (options_.refused_by_bus) (void)options_.refused_by_bus();
  // Subscribed first: what comes while the past is restored waits on the bus.
  if (Status status = bus_.subscribe_service_topics(); !status) return status;
  if (Status status = bus_.subscribe(inputs_); !status) return status;
  if (Status status = bus_.announce(outputs_); !status) return status;
  const auto positions = journal_.positions();
  if (!positions) return fail(positions.error());
  std::vector<StreamPosition> streams;
  for (const StreamPosition& known : *positions) {
    if (restore_name(known)) continue;
    streams.push_back(known);
    committed_[{known.topic, known.writer_id}] = known.sequence;
    kept_streams_.insert({known.topic, known.writer_id});
    strangers_.expect(known.writer_id);
  }
  reader_ = std::make_unique<StreamReader>(journal_.writer_id(), streams, options_.streams);
  // Nothing is missing yet; from now on it knows the time, by which it forgets whom it does not hear.
  (void)reader_->requests(std::chrono::duration<double>(steady_clock::now().time_since_epoch()).count());

  if (Status status = lanes_.prepare(); !status) return status;
  for (const std::string& asset_id : options_.assets) lanes_.know(asset_id);
  if (options_.local_inputs) options_.local_inputs->on_some([&bus = bus_] { bus.wake(); });
  if (Status status = restore_quarantine(); !status) return status;
  if (Status status = restore_refused_tests(); !status) return status;
  if (Status status = restore_awaiting(); !status) return status;
  if (Status status = restore_past(); !status) return status;
  if (Status status = look_at_own_acts(); !status) return status;
  if (Status status = record_earlier_acts(); !status) return status;
  const auto is_new = journal_.is_new();
  if (!is_new) return fail(is_new.error());
  const auto anchors = journal_.anchors();
  if (!anchors) return fail(anchors.error());
  for (const AuditAnchor& heard : *anchors) compared_.insert(heard.service);
  is_new_ = *is_new;
  waits_for_acts_ = is_new_ && keeps_acts() && !options_.strangers.services.empty();
  started_ns_ = clock_.now().nanoseconds;
  clock_watch_.begin(journal_.last_used(), clock_.now(), steady_clock::now().time_since_epoch());
  if (options_.watches_clock && clock_watch_.step_s()) tell_of_step();
  look_at_clock();
  if (Status status = publish_latest(); !status) return status;
  started_ = steady_clock::now();
  ServiceStatus status;
  status.service = kind_->name();
  status.writer_id = journal_.writer_id();
  status.version = options_.version;
  status.started_ns = started_ns_;
  status.process_id = ::getpid();
  status.state = forgotten_.empty() ? "running" : kRestoring;
  status.written = written();    // the first heartbeat tells of acts, which others compare with their own record,
  status.received = received();  // and of what was read, which they compare with their own journal
  alarms_.tell(status);
  Heartbeat::Options beats = options_.heartbeat;
  const bool takes_samples = std::ranges::find(kind_->inputs(), Topic::raw_samples) != kind_->inputs().end();
  auto confirmed = std::make_shared<ConfirmedPositions>(journal_.to_disk(), takes_samples);
  beats.before_beat = [confirmed](ServiceStatus& said) { return confirmed->make_sure(said); };
  heartbeat_ = std::make_unique<Heartbeat>(heartbeat_bus_, clock_, status, std::move(beats));
  report_progress();
  return {};
}

Status LayerRunner::run(const std::atomic<bool>& stop) {
  while (!stop) {
    const auto until_next_second =
        std::chrono::duration_cast<std::chrono::milliseconds>(last_second_ + kSecond - steady_clock::now());
    const auto timeout = std::clamp(until_next_second, std::chrono::milliseconds(1), kSecond);
    if (Status status = step(timeout); !status) {
      // The last heartbeat says why: who looks hears of a service that starts again and again.
      note_error(status.error().describe());
      if (heartbeat_) heartbeat_->update([this](ServiceStatus& last) { last.last_error = last_error_; });
      return status;
    }
  }
  return {};
}

Status LayerRunner::step(std::chrono::milliseconds timeout) {
  if (!full_since_) std::this_thread::sleep_until(last_work_ + options_.batch_pause);
  timeout = until_looking_back(timeout);
  if (lanes_.on_trial()) timeout = std::min(timeout, kTrialLook);
  if (!outbox_.empty() || !resends_.empty()) timeout = std::min(timeout, Outbox::kShortestPause);
  const bool may_resend = resends_.next(steady_clock::now()).has_value();
  const bool takes_local = may_take_local();
  const bool work_waits = !ready_.empty() || may_resend || takes_local;
  std::vector<BusItem> items = bus_.receive(work_waits ? std::chrono::milliseconds(0) : timeout, kBatch);
  if (items.size() < kBatch && !bus_.has_more())
    full_since_.reset();
  else if (!full_since_)
    full_since_ = steady_clock::now();
  const bool is_idle = items.empty() && ready_.empty();
  for (BusItem& item : items) sort_in(std::move(item));
  if (takes_local) take_local();
  if (Status status = take_ready(); !status) return status;
  look_whether_acts_are_here();
  send_outbox();
  if (Status status = serve_resends(); !status) return status;
  send_requests();
  if (Status status = look_back_in_passing(is_idle); !status) return status;
  if (steady_clock::now() - last_second_ >= kSecond) {
    last_second_ = steady_clock::now();
    if (Status there = journal_.is_in_place(); !there) return there;
    give_memory_back();
    if (Status status = try_again_what_was_asked(); !status) return status;
    if (Status status = let_time_pass(); !status) return status;
    if (Status status = note_acts(); !status) return status;
    look_whether_assets_are_quiet();
    if (Status status = end_waits(); !status) return status;
    if (Status status = publish_latest(); !status) return status;
    if (Status status = drop_old_samples(); !status) return status;
  }
  report_progress();
  return {};
}

Status LayerRunner::in_batch(const std::function<Status()>& work, Survives survives) {
  Status status = journal_.begin(survives);
  if (status) status = work();
  if (status) status = keep_alarms();
  if (status) status = journal_.commit();
  if (!status) {
    journal_.rollback();
    return status;
  }
  for (const auto& [stream, sequence] : uncommitted_) committed_[stream] = sequence;
  uncommitted_.clear();
  if (committed_.size() > kept_streams_.size() + options_.most_positions)
    std::erase_if(committed_, [this](const auto& one) { return !kept_streams_.contains(one.first); });
  // Told before it is sent: a reader must never see a message that the heartbeat does not know yet.
  report_progress();
  send_outbox();
  return {};
}

/// What people say, and recordings from a directory, which move on, nobody keeps who could be asked for them again.
/// Samples that are sent come too often for that: they are on the disk before the heartbeat tells of them.
Survives LayerRunner::batch_survives() const {
  const bool said_once = std::ranges::any_of(taken_, [](const Taken& one) {
    return one.stream.sequence == 0 && topic_of(*one.message) != Topic::raw_samples;
  });
  const bool refused = std::ranges::any_of(results_, [](const auto& one) { return !one.conclusion.refused.empty(); });
  const bool acted = !acts_.empty() || !records_.empty() || !no_longer_awaiting_.empty() || refused;
  return said_once || acted || took_local_ ? Survives::power_cuts : Survives::kills;
}

Status LayerRunner::take_ready() {
  if (!ready_.empty()) {
    last_work_ = steady_clock::now();
    holds_memory_ = true;
  }
  if (Status status = release_records(); !status) return status;
  if (Status status = give_acts_ahead(); !status) return status;
  if (Status status = take_all_in_turn(); !status) return status;
  if (Status status = let_lanes_work(); !status) return status;
  if (!taken_.empty() || !results_.empty() || !uncommitted_.empty() || !acts_.empty() || !records_.empty() ||
      !changed_refused_tests_.empty())
    if (Status status = in_batch([this] { return store_batch(); }, batch_survives()); !status) return status;
  took_local_ = false;
  lanes_.save_memory();
  return take_failures();
}

/// Its id when it is to be taken, none when it came before.
Result<std::optional<std::string>> LayerRunner::identify_input(const Message& message) {
  Error problem;
  const auto value_of_result = [&problem]<class T>(Result<T> result) {
    if (!result) problem = result.error();
    return std::move(result).value_or(T());
  };
  const EarlierInputs earlier = {.has =
                                     [&](const std::string& known) {
                                       return taken_ids_.contains(known) || value_of_result(journal_.has_input(known));
                                     },
                                 .last_unnumbered =
                                     [&](Topic topic, const std::string& asset) {
                                       const auto last = last_unnumbered_.find({topic, asset});
                                       return last != last_unnumbered_.end()
                                                  ? last->second
                                                  : value_of_result(journal_.last_unnumbered_input(topic, asset));
                                     }};
  auto id = identify(message, earlier);
  if (!problem.rule.empty()) return fail(problem);
  return id;
}

Result<std::optional<std::string>> LayerRunner::asset_of_input(const std::string& message_id) {
  if (const auto taken = taken_ids_.find(message_id); taken != taken_ids_.end())
    return asset_of(*taken_[taken->second].message);
  return journal_.asset_of_input(message_id);
}

/// A replacement that an earlier version kept under the id that it came with has that id still. An id that is another
/// asset's is no sign that this message came before.
Status LayerRunner::name_as_kept(Message& message) {
  if (header_of(message).message_id.empty()) return {};
  auto known = asset_of_input(header_of(message).message_id);
  if (known && *known != asset_of(message) && topic_of(message) == Topic::maintenance_event) {
    name_replacement(message);
    known = asset_of_input(header_of(message).message_id);
  }
  if (!known) return fail(known.error());
  if (*known && **known != asset_of(message)) header_of(message).message_id = id_beside_another_asset(message);
  return {};
}

/// Whoever says the same again is refused again.
std::optional<std::string> LayerRunner::refusal_of_content(const Message& message) const {
  auto refused = admission_.refusal(message, clock_.now());
  return refused ? refused : refusal_of_nameless(message);
}

std::optional<std::string> LayerRunner::refusal_of(const Message& message, const ActRecord* record) const {
  auto refused = record == nullptr ? refusal_of_content(message) : admission_.refusal_of_recorded(message);
  if (!refused) refused = refusal_of_confirmation(message, record);
  if (!refused && (record == nullptr || record->is_ahead)) refused = refusal_of_ahead(message);
  if (refused || record != nullptr) return refused;  // what a neighbour took was counted there
  refused = refusal_of_waiting(message);
  return refused ? refused : refusal_of_many(message);
}

Status LayerRunner::take(Message message, const ActRecord* record) {
  const bool is_false = is_false_record(message);
  if (Status named = name_as_kept(message); !named) return named;
  const Header& header = header_of(message);
  StreamPosition stream;
  if (is_numbered(message)) {
    stream = {std::string(name_of(topic_of(message))), header.writer_id, header.stream_sequence};
    uncommitted_[{stream.topic, stream.writer_id}] = stream.sequence;
    if (kept_streams_.size() < options_.most_positions) kept_streams_.insert({stream.topic, stream.writer_id});
  }
  const bool from_bus = topic_of(message) == Topic::raw_samples && is_numbered(message);
  if (from_bus && !strangers_.admits(message)) return {};
  // Read, and not kept: its stream goes on, and the journal does not grow by what strangers invent.
  if (const auto refused = admission_.refusal_of_asset(message)) {
    note_unknown_asset(message, *refused);
    return {};
  }
  if (is_false) return {};
  if (is_numbered(message)) kept_streams_.insert({stream.topic, stream.writer_id});
  if (Status recalled = recall(asset_of(message)); !recalled) return recalled;
  const auto id = identify_input(message);
  if (!id) return fail(id.error());
  if (!*id) {
    if (record != nullptr) note_taken_elsewhere(*record, message);
    if (is_numbered(message)) renumbered_.push_back(std::move(message));
    return {};
  }
  header_of(message).message_id = **id;
  if (topic_of(message) == Topic::act_record) return take_record(std::move(message), stream);
  const std::string id_if_refused = record == nullptr && is_an_act(message) ? id_of_refused(message) : std::string();
  if (record == nullptr)
    name_tests(message);
  else if (const auto* event = std::get_if<MaintenanceEvent>(&message))
    admission_.note_named_tests(*event);
  auto refused = refusal_of(message, record);
  const bool keeps_id_free = refused && !id_if_refused.empty() && refusal_of_content(message);
  if (keeps_id_free) {
    const auto is_known = taken_ids_.contains(id_if_refused) ? Result<bool>(true) : journal_.has_input(id_if_refused);
    if (!is_known) return fail(is_known.error());
    if (*is_known) return {};
  }
  if (refused) {
    note_error(std::string(name_of(topic_of(message))) + " refused: " + *refused);
    log_message(LogLevel::warn, "refused", message, {{"reason", *refused}});
    // Not journaled: the id of a recording says nothing of its start time, and the corrected one comes under the same.
    if (const auto* raw = std::get_if<RawSamples>(&message)) {
      note_refused_test(*raw, *refused);
      return {};
    }
    const bool is_said_here = record == nullptr && is_an_act(message) && is_listened_to(message);
    if (is_said_here) tell_of_many(message, *refused);
    if (is_said_here && !keeps_refused(message, *refused)) return {};
    if (may_be_fetched_later(message)) {
      (void)note_act(message, refused, InputState::consumed, record);
      return {};
    }
  }
  if (is_of_a_service(name_of(topic_of(message))) && is_numbered(message)) note_conclusion(message, refused);
  if (!refused) admission_.note_asset(asset_of(message));
  if (!refused && record == nullptr) count_act(message);
  const bool for_desk = is_for_desk(message, record != nullptr);
  if (for_desk && !refused) refused = record == nullptr ? tell_desk(message) : recall_at_desk(message);
  InputState state = is_set_aside(message) ? InputState::set_aside : InputState::open;
  if (for_desk) state = record == nullptr || refused ? InputState::consumed : InputState::ahead;
  if (!is_listened_to(message))
    state = InputState::consumed;  // kept for those who lose it
  else if (!for_desk || desk_)
    state = note_act(message, refused, state, record);
  if (!refused && is_to_be_kept(message, for_desk)) keep_record(message, !for_desk && state == InputState::ahead);
  if (state == InputState::open && has_no_samples_any_more(message)) state = InputState::consumed;
  const std::string asset_id = asset_of(message);
  if (keeps_id_free) header_of(message).message_id = id_if_refused;
  const std::string kept_id = header_of(message).message_id;
  taken_ids_[kept_id] = taken_.size();
  if (stream.sequence == 0) last_unnumbered_[{topic_of(message), asset_id}] = kept_id;
  const auto input = std::make_shared<const Message>(without_stamps(std::move(message)));
  taken_.push_back({input, stream, state});
  if (state == InputState::awaiting) await(input, clock_.now());
  if (state == InputState::ahead && !for_desk) {
    ++acts_ahead_[asset_id];
    if (record == nullptr || record->is_ahead) said_ahead_[kept_id] = {asset_id, time_said(record)};
  }
  if (state == InputState::consumed && !refused) confirm(*input);
  if (state != InputState::open) return {};
  if (admission_.note(*input, false)) heard_of_.insert(asset_id);
  const auto* const raw = std::get_if<RawSamples>(input.get());
  if (raw != nullptr) note_good_test(*raw);
  if (raw == nullptr || raw->block_number == 0) look_for_future_test(asset_id);
  replaying_[asset_id] = header_of(*input).replay;
  log_message(LogLevel::debug, "received", *input);
  lanes_.add(asset_id, **id, input);
  return {};
}

/// Also one that was taken just now, and is in the journal with all of its batch.
Result<std::optional<Message>> LayerRunner::input(const std::string& message_id) {
  const auto taken = taken_ids_.find(message_id);
  return taken == taken_ids_.end() ? journal_.input(message_id) : std::optional(*taken_[taken->second].message);
}

Status LayerRunner::let_lanes_work() {
  const auto end = steady_clock::now() + options_.batch_time;
  const auto goes_on = [this] {
    return std::ranges::any_of(taken_,
                               [this](const Taken& one) { return lanes_.is_receiving(asset_of(*one.message)); });
  };
  for (;;) {
    if (Status status = lanes_.advance(); !status) return status;
    for (LaneResult& result : lanes_.take_results()) results_.push_back(std::move(result));
    if (Status status = lanes_.advance(); !status) return status;
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - steady_clock::now());
    if (left.count() <= 0 || !goes_on()) return {};
    lanes_.wait(left);
  }
}

/// A recording of an hour gives more blocks than the layers behind read in a minute. What is live goes through the same
/// streams: it must not find them full (docs/decisions/flow-control.md).
bool LayerRunner::may_take_local() {
  return options_.local_inputs && outbox_.empty() && lanes_.open() <= options_.most_open_beside_local &&
         options_.local_inputs->has_some() && !is_a_reader_behind();
}

void LayerRunner::hear_reader(const ServiceStatus& status) {
  const auto& services = options_.strangers.services;
  if (!services.empty() && std::ranges::find(services, status.service) == services.end()) return;
  for (const StreamPosition& position : status.received)
    if (const auto topic = value_of<Topic>(position.topic); topic && position.writer_id == journal_.writer_id())
      readers_[status.service].read[*topic] = position.sequence;
  if (const auto known = readers_.find(status.service); known != readers_.end())
    known->second.heard = steady_clock::now();
}

bool LayerRunner::is_a_reader_behind() const {
  const auto now = steady_clock::now();
  return std::ranges::any_of(readers_, [&](const auto& known) {
    const Reader& reader = known.second;
    return now - reader.heard < kReaderIsGone && std::ranges::any_of(reader.read, [&](const auto& stream) {
             const auto written = journal_.written().find(stream.first);
             return written != journal_.written().end() &&
                    written->second > stream.second + stream_window(name_of(stream.first));
           });
  });
}

void LayerRunner::take_local() {
  for (Message& message : options_.local_inputs->take()) {
    ready_.push_back(std::move(message));
    took_local_ = true;
  }
}

bool LayerRunner::stop(std::chrono::milliseconds patience) {
  const bool is_over = !options_.local_inputs || options_.local_inputs->stop(patience);
  return lanes_.stop(patience) && is_over;
}

Status LayerRunner::store_batch() {
  for (const LaneResult& result : results_)
    for (const std::string& id : result.conclusion.consumed)
      if (const auto taken = taken_ids_.find(id); taken != taken_ids_.end())
        taken_[taken->second].state = InputState::consumed;
  for (const Taken& one : taken_)
    if (Status status = journal_.add_input(*one.message, one.stream, clock_.now(), one.state); !status) return status;
  if (Status status = record_acts(); !status) return status;
  if (Status status = keep({.outputs = std::exchange(records_, {}), .consumed = {}}); !status) return status;
  if (Status status = keep_refused_tests(); !status) return status;
  for (const auto& [stream, sequence] : uncommitted_) {
    if (!kept_streams_.contains(stream)) continue;
    if (Status status = journal_.set_position({stream.first, stream.second, sequence}); !status) return status;
  }
  for (LaneResult& result : results_)
    if (Status status = keep(std::move(result.conclusion)); !status) return status;
  for (const Message& message : std::exchange(renumbered_, {}))
    if (Status status = journal_.renumber_input(message); !status) return status;
  taken_.clear();
  taken_ids_.clear();
  last_unnumbered_.clear();
  return {};
}

Status LayerRunner::keep(Conclusion conclusion) {
  last_work_ = steady_clock::now();
  holds_memory_ = true;
  for (Message& output : conclusion.outputs) {
    auto kept = journal_.add_output(std::move(output), clock_.now());
    if (!kept) return fail(kept.error());
    if (!*kept) continue;
    latest_.concluded(**kept, header_of(**kept).stream_sequence);
    note_remembered(asset_of(**kept));
    forget_damage(header_of(**kept).message_id);
    note_alarms_of(**kept);
    note_advice_of(**kept);
    note_standing(**kept);
    // Data acquisition knows a test by its name only from its own blocks on.
    if (admission_.note(**kept)) heard_of_.insert(asset_of(**kept));
    outbox_.add(std::move(**kept));
  }
  for (const Refusal& refused : conclusion.refused)
    if (Status told = tell(refused); !told) return told;
  for (const std::string& id : conclusion.consumed) {
    if (taken_ids_.contains(id)) continue;
    if (Status status = journal_.consume(id); !status) return status;
  }
  return {};
}

/// After a burst of work an idle service is as small as before it.
void LayerRunner::give_memory_back() {
  if (!holds_memory_ || steady_clock::now() - last_work_ < kSecond) return;
  ::malloc_trim(0);
  holds_memory_ = false;
}

Status LayerRunner::let_time_pass() {
  look_for_trouble();
  if (Status looked = let_time_pass_at_desk(); !looked) return looked;
  const auto at_rest = [this](const std::string& asset_id) {
    return forgotten_.contains(asset_id) || asleep_.contains(asset_id) ? nullptr : lanes_.at_rest(asset_id);
  };
  Status woken;
  const auto woken_at_rest = [&](const std::string& asset_id) -> const Layer* {
    if (woken && asleep_.contains(asset_id)) woken = recall(asset_id);
    return woken ? at_rest(asset_id) : nullptr;
  };
  if (options_.local_inputs) options_.local_inputs->look(woken_at_rest, at_rest);
  tell_of_local_inputs();
  if (!woken) return woken;
  const auto now = steady_clock::now();
  if (now - started_ < options_.settling || (full_since_ && now - *full_since_ < options_.longest_wait)) return {};
  for (const std::string& asset_id : lanes_.assets()) {
    Layer* const layer = at_rest(asset_id);
    if (layer == nullptr) continue;
    tell_of_waiting(asset_id, *layer);
    if (time_stands_still(asset_id) || may_be_on_its_way(asset_id)) continue;
    Conclusion conclusion = layer->tick(believed_time());
    if (conclusion.outputs.empty() && conclusion.consumed.empty()) continue;
    const Survives survives = conclusion.refused.empty() ? Survives::kills : Survives::power_cuts;
    if (Status status = in_batch([&] { return keep(std::move(conclusion)); }, survives); !status) return status;
  }
  return {};
}

/// What is concluded from the time alone, a test that is overdue, stays: while the clock may be wrong, time goes on as it
/// did before it was set.
UtcTime LayerRunner::believed_time() const {
  const double step_s = options_.read_clock ? clock_watch_.step_s().value_or(0.0) : 0.0;
  return add_seconds(clock_.now(), -step_s);
}

/// A history that is played back is over. An asset that lives goes on beside it, and so does one that should: of which
/// is known since when tests are due.
bool LayerRunner::time_stands_still(const std::string& asset_id) {
  return replaying_[asset_id] && !admission_.has_live_tests(asset_id) && !options_.commissioned.contains(asset_id);
}

/// A test is not overdue or lost while messages about it may be on their way.
bool LayerRunner::may_be_on_its_way(const std::string& asset_id) {
  const bool may = reader_->is_behind(asset_id) ||
                   std::ranges::any_of(ready_, [&](const Message& message) { return asset_of(message) == asset_id; });
  if (!may) return behind_since_.erase(asset_id), false;
  const auto now = steady_clock::now();
  return now - behind_since_.try_emplace(asset_id, now).first->second < options_.longest_behind;
}

// With its time: it stays in the status until another one comes.
void LayerRunner::note_error(const std::string& text) { last_error_ = format_utc(clock_.now()) + " " + text; }

std::vector<StreamPosition> LayerRunner::position_of_acts() const {
  if (last_act_.sequence == 0) return {};
  return {{kActsTopic, last_act_.hash, static_cast<std::uint64_t>(last_act_.sequence)}};
}

std::vector<StreamPosition> LayerRunner::written() const {
  std::vector<StreamPosition> written;
  for (const auto& [topic, sequence] : journal_.written())
    written.push_back({std::string(name_of(topic)), journal_.writer_id(), sequence});
  // Also where nothing stands in it: who has no such stream has acts that nobody can fetch back.
  if (!journal_.written().contains(Topic::act_record))
    written.push_back({std::string(name_of(Topic::act_record)), journal_.writer_id(), 0});
  std::ranges::copy(position_of_acts(), std::back_inserter(written));
  return written;
}

/// Of services also what is silent: who lost its journal goes on under another name, and learns here what it has lost.
std::vector<StreamPosition> LayerRunner::received() const {
  constexpr std::size_t kMostSilent = 64;
  std::vector<StreamPosition> received;
  const std::vector<Key> active = reader_->active();
  for (const Key& stream : active) {
    const auto position = committed_.find(stream);
    received.push_back({stream.first, stream.second, position == committed_.end() ? 0 : position->second});
  }
  for (const auto& [stream, position] : committed_) {
    if (received.size() >= active.size() + kMostSilent) break;
    if (is_of_a_service(stream.first) && std::ranges::find(active, stream) == active.end())
      received.push_back({stream.first, stream.second, position});
  }
  for (const auto& [topic, name] : first_names_) received.push_back({topic, name, 1});
  return received;
}

void LayerRunner::report_progress() {
  if (!heartbeat_) return;  // the past is still being restored
  std::vector<StreamPosition> received = this->received();
  heartbeat_->update([&](ServiceStatus& status) {
    // What a layer keeps as its memory waits for nothing; nor does what belongs to a test that is set aside elsewhere.
    const std::uint64_t open = journal_.open_inputs();
    const std::uint64_t idle = std::min<std::uint64_t>(lanes_.held() + waiting_in_vain_, open);
    status.pending_inputs = std::max<std::uint64_t>(open - idle, lanes_.open()) + ready_.size();
    status.written = written();
    status.received = std::move(received);
    status.last_error = last_error_;
    status.state = forgotten_.empty() ? "running" : kRestoring;
    alarms_.tell(status);
    status.desk = told_at_desk_.desk;
    status.desk_count = told_at_desk_.desk_count;
  });
}

}  // namespace sealwatch

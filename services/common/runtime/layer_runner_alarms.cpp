// The runner's part in telling what keeps it from seeing: another service of its kind, strangers, a clock that nobody
// can trust, sensors that are gone. Each is an alarm for as long as it stands.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "sealwatch/core/visible_text.hpp"
#include "sealwatch/message/outside.hpp"
#include "services/common/runtime/layer_runner.hpp"
#include "services/common/runtime/log.hpp"
#include "services/common/runtime/operator_acts.hpp"

namespace sealwatch {
namespace {

using std::chrono::steady_clock;

constexpr const char* kRival = "rival";
constexpr const char* kUnknownWriter = "unknown_writer";
constexpr const char* kUnknownAsset = "unknown_asset";
constexpr const char* kRefusedRight = "refused_right";
constexpr const char* kFutureTest = "future_test";
constexpr const char* kRefusedTest = "refused_test";
constexpr const char* kRefusedConclusion = "refused_conclusion";
constexpr const char* kClockStep = "clock_step";
constexpr const char* kClockUnsynchronised = "clock_unsynchronised";
constexpr const char* kFlood = "flood";
constexpr const char* kMissingBlocks = "missing_blocks";
constexpr const char* kUnpublishedModel = "unpublished_model";
constexpr const char* kOtherSenders = "others";
constexpr std::size_t kMostNamedRefusals = 8;
constexpr std::ptrdiff_t kMostRefusedSenders = 4;  ///< of an asset
constexpr std::chrono::seconds kFloodIsOver{60};
/// It is raised every second while they are missing.
constexpr std::chrono::seconds kBlocksCame{5};
/// A service beats once a second.
constexpr std::chrono::seconds kRivalIsSilent{10};

Alarms::Steady steady_now() { return steady_clock::now().time_since_epoch(); }

}  // namespace

/// Both conclude from the same messages, each under its own name: readers take what comes first, people see both.
void LayerRunner::note_rival(const ServiceStatus& rival) {
  if (rival.state == "stopping") {
    alarms_.clear(kRival, {}, rival.writer_id);
    return;
  }
  const std::string text = "another " + rival.service + ", process " + std::to_string(rival.process_id) +
                           ", runs in this domain; stop one of the two, or give it another domain";
  const bool is_new = alarms_.raise({.kind = kRival,
                                     .asset_id = {},
                                     .subject = rival.writer_id,
                                     .pst_id = {},
                                     .text = text,
                                     .since_ns = clock_.now().nanoseconds},
                                    steady_now() + kRivalIsSilent);
  if (!is_new) return;
  last_error_ = text;
  log_event(LogLevel::error, "not alone", {{"error", text}, {"writer", rival.writer_id}});
}

void LayerRunner::hear_name(const ServiceStatus& status) {
  note_strangers(strangers_.hear(status, steady_now()));
  if (strangers_.knows(status.writer_id) && alarms_.clear(kUnknownWriter, {}, status.writer_id))
    log_event(LogLevel::info, "writer is known now", {{"writer", status.writer_id}, {"service", status.service}});
}

void LayerRunner::note_strangers(const std::vector<StrangerWatch::Stranger>& strangers) {
  for (const StrangerWatch::Stranger& one : strangers) {
    const bool is_new = alarms_.raise({.kind = kUnknownWriter,
                                       .asset_id = {},
                                       .subject = one.name,
                                       .pst_id = {},
                                       .text = one.text,
                                       .since_ns = clock_.now().nanoseconds},
                                      steady_now() + options_.strangers_stand);
    if (is_new) log_event(LogLevel::error, "unknown writer", {{"writer", one.name}, {"error", one.text}});
  }
}

/// One for all of them: whoever invents assets invents many. What people said of them stands in the audit trail as all
/// that is refused does: not without end.
void LayerRunner::note_unknown_asset(const Message& message, const std::string& refused) {
  const bool is_new = alarms_.raise({.kind = kUnknownAsset,
                                     .asset_id = {},
                                     .subject = {},
                                     .pst_id = {},
                                     .text = refused,
                                     .since_ns = clock_.now().nanoseconds},
                                    steady_now() + options_.strangers_stand);
  if (auto act = act_of(message, clock_.now(), refused); act && keeps_refused(message, refused))
    acts_.push_back(std::move(*act));
  if (!is_new) return;
  note_error(refused);
  log_event(LogLevel::error, "unknown asset", {{"error", refused}});
}

/// Of whoever gives tests their names, which all layers conclude from: six would say the same. A replay ahead of the
/// clock is a simulated life, or a slip in the year of a recording, which nobody can tell before the asset lives.
void LayerRunner::look_for_future_test(const std::string& asset_id) {
  if (std::ranges::find(kind_->inputs(), Topic::raw_samples) == kind_->inputs().end()) return;
  const UtcTime now = clock_.now();
  const auto future = admission_.future_test_before_live(asset_id, now);
  if (!future) {
    alarms_.clear(kFutureTest, asset_id, {});
    return;
  }
  const std::string text = "a test of " + format_utc(*future) +
                           " was played back, so that live tests change no advice; retract what is of the future: "
                           "sealwatch retract " +
                           asset_id + " --since " + format_date(add_seconds(now, kSecondsPerDay)) +
                           " --by NAME --reason WHY";
  const bool is_new = alarms_.raise({.kind = kFutureTest,
                                     .asset_id = asset_id,
                                     .subject = {},
                                     .pst_id = {},
                                     .text = text,
                                     .since_ns = now.nanoseconds});
  if (!is_new) return;
  note_error(asset_id + ": " + text);
  log_event(LogLevel::error, "test of the future", {{"asset", asset_id}, {"error", text}});
}

/// Its blocks count as received, and its sender lets go of them: nobody else would learn that a test is lost, or that
/// the sender's clock is wrong and the next ones will be as well. Who plays a recording back is told. Assets and senders
/// may be invented: those that nobody knows share one alarm, and of one asset so many senders are told apart.
void LayerRunner::note_refused_test(const RawSamples& raw, const std::string& refused) {
  if (raw.header.replay) return;
  const UtcTime now = clock_.now();
  ServiceAlarm alarm{.kind = kRefusedTest,
                     .asset_id = raw.asset_id,
                     .subject = raw.source_id,
                     .pst_id = {},
                     .text = refused,
                     .since_ns = now.nanoseconds};
  const auto known = std::ranges::find_if(refused_tests_, [&](const RefusedTest& one) { return is_of(one, raw); });
  if (known != refused_tests_.end()) {
    known->last = now;
    known->recording_id = raw.recording_id;
    known->heard = steady_now();
    return;
  }
  const auto of_asset =
      std::ranges::count_if(refused_tests_, [&](const RefusedTest& one) { return one.alarm.asset_id == raw.asset_id; });
  const bool has_name = raw.source_id.size() <= kLongestId && is_visible(raw.source_id);
  if (!admission_.knows(raw.asset_id) || !has_name) {
    alarm.asset_id = alarm.subject = {};
    alarms_.raise(std::move(alarm), steady_now() + options_.strangers_stand);
  } else if (of_asset < kMostRefusedSenders) {
    refused_tests_.push_back({alarm, now, raw.recording_id, steady_now()});
    changed_refused_tests_.emplace_back(std::move(alarm), true);
    tell_of_refused_tests();
  }
}

/// What another layer concluded and this one refuses is missing from all that would follow from it, and nobody sends it
/// again: a test without advice, which looks like one that needs none. The next one that is taken ends it. What is
/// damaged in its writer's journal is told there. (What has no number comes from no layer: strangers are told apart.)
/// Where there is a desk, it keeps what became of the alarm.
void LayerRunner::note_conclusion(const Message& message, const std::optional<std::string>& refused) {
  const std::string asset_id = asset_of(message), topic(name_of(topic_of(message)));
  ServiceAlarm alarm{.kind = kRefusedConclusion,
                     .asset_id = asset_id,
                     .subject = topic,
                     .pst_id = {},
                     .text = refused.value_or(""),
                     .since_ns = clock_.now().nanoseconds};
  if (!refused) {
    if (alarms_.clear(kRefusedConclusion, asset_id, topic) && !options_.desk)
      changed_refused_tests_.emplace_back(std::move(alarm), false);
  } else if (header_of(message).message_id.starts_with(kDamagedMessage)) {
    return;
  } else if (!admission_.knows(asset_id)) {
    alarm.asset_id.clear();
    alarms_.raise(std::move(alarm), steady_now() + options_.strangers_stand);
  } else if (alarms_.raise(alarm)) {
    changed_refused_tests_.emplace_back(std::move(alarm), true);
  }
}

/// Where many are refused at once (this machine's clock is wrong), the first few are named: there is room for other alarms.
void LayerRunner::tell_of_refused_tests() {
  for (std::size_t k = 0; k < refused_tests_.size(); ++k) {
    const ServiceAlarm& alarm = refused_tests_[k].alarm;
    if (k < kMostNamedRefusals)
      alarms_.raise(alarm);
    else
      alarms_.clear(alarm.kind, alarm.asset_id, alarm.subject);
  }
  alarms_.clear(kRefusedTest, {}, kOtherSenders);
  if (refused_tests_.size() <= kMostNamedRefusals) return;
  const ServiceAlarm& first = refused_tests_[kMostNamedRefusals].alarm;
  alarms_.raise({.kind = kRefusedTest,
                 .asset_id = {},
                 .subject = kOtherSenders,
                 .pst_id = {},
                 .text = "tests of " + std::to_string(refused_tests_.size() - kMostNamedRefusals) +
                         " more are refused, among them: " + first.text,
                 .since_ns = first.since_ns});
}

/// What its sender recorded after the refusal shows that it is mended, or the refused recording itself, corrected. An old
/// recording shows nothing.
void LayerRunner::note_good_test(const RawSamples& raw) {
  if (raw.header.replay || raw.block_number != 0) return;
  const UtcTime time = raw.start_time_known ? UtcTime{raw.start_time_ns} : clock_.now();
  end_refused_tests([&](const RefusedTest& one) {
    const bool is_corrected = !raw.recording_id.empty() && one.recording_id == raw.recording_id;
    return is_of(one, raw) && (is_corrected || time >= one.last);
  });
}

void LayerRunner::end_refused_tests(const std::function<bool(const RefusedTest&)>& is_over) {
  const std::size_t before = refused_tests_.size();
  std::erase_if(refused_tests_, [&](const RefusedTest& one) {
    if (!is_over(one)) return false;
    alarms_.clear(kRefusedTest, one.alarm.asset_id, one.alarm.subject);
    changed_refused_tests_.emplace_back(one.alarm, false);
    log_event(LogLevel::info, "tests are refused no more",
              {{"asset", one.alarm.asset_id}, {"source", one.alarm.subject}});
    return true;
  });
  if (refused_tests_.size() != before) tell_of_refused_tests();
}

bool LayerRunner::is_of(const RefusedTest& refused, const RawSamples& raw) {
  return refused.alarm.asset_id == raw.asset_id && refused.alarm.subject == raw.source_id;
}

/// The sender does not send them again after a restart: the alarm would be over, and the test as lost as before.
Status LayerRunner::restore_refused_tests() {
  auto kept = journal_.alarms();
  if (!kept) return fail(kept.error());
  for (const AlarmEntry& one : *kept) {
    if (one.service != kind_->name()) continue;
    if (one.alarm.kind == kRefusedConclusion && one.ended_ns == 0) alarms_.raise(one.alarm);
    if (one.alarm.kind == kRefusedTest && reads_samples())
      refused_tests_.push_back({one.alarm, {one.alarm.since_ns}, {}, steady_now()});
  }
  std::ranges::stable_sort(refused_tests_, {}, [](const RefusedTest& one) { return one.alarm.since_ns; });
  tell_of_refused_tests();
  return {};
}

/// In the batch that is being written.
Status LayerRunner::keep_refused_tests() {
  for (const auto& [alarm, stands] : std::exchange(changed_refused_tests_, {})) {
    AlarmEntry entry;
    entry.service = kind_->name();
    entry.alarm = alarm;
    if (Status kept = stands ? journal_.keep_alarm(entry) : journal_.forget_alarm(alarm); !kept) return kept;
  }
  return {};
}

void LayerRunner::look_at_clock() {
  const bool step_changed = clock_watch_.look(clock_.now(), steady_now());
  if (options_.read_clock) clock_reading_ = options_.read_clock();
  if (options_.watches_clock) tell_of_synchronisation(clock_reading_.quality);
  if (options_.watches_clock && step_changed) tell_of_step();
  if (options_.read_clock && clock_watch_.step_s()) clock_reading_.quality = ClockQuality::stepped;
}

void LayerRunner::tell_of_step() {
  alarms_.clear(kClockStep, {}, {});
  const auto step_s = clock_watch_.step_s();
  if (!step_s) return log_event(LogLevel::info, "the clock goes on as it did", {});
  const std::string text = "this machine's clock was set " + std::string(*step_s > 0.0 ? "forward" : "back") + " by " +
                           std::to_string(std::llround(std::abs(*step_s))) +
                           " s, or the machine slept; check the time source: tests are dated by this clock";
  alarms_.raise({.kind = kClockStep,
                 .asset_id = {},
                 .subject = {},
                 .pst_id = {},
                 .text = text,
                 .since_ns = clock_.now().nanoseconds});
  log_event(LogLevel::error, "clock was set", {{"error", text}});
}

void LayerRunner::tell_of_synchronisation(ClockQuality quality) {
  if (quality == ClockQuality::unknown) return;  // what stood, stands: nothing was learnt
  if (quality == ClockQuality::synchronised) {
    if (alarms_.clear(kClockUnsynchronised, {}, {})) log_event(LogLevel::info, "the clock is synchronised", {});
    return;
  }
  const std::string text =
      "this machine's clock follows no time source and drifts; tests are dated by it: let chrony or "
      "systemd-timesyncd set it";
  const bool is_new = alarms_.raise({.kind = kClockUnsynchronised,
                                     .asset_id = {},
                                     .subject = {},
                                     .pst_id = {},
                                     .text = text,
                                     .since_ns = clock_.now().nanoseconds});
  if (is_new) log_event(LogLevel::warn, "clock is not synchronised", {{"error", text}});
}

void LayerRunner::tell_of_local_inputs() {
  if (!options_.local_inputs) return;
  const std::vector<ServiceAlarm> standing = options_.local_inputs->alarms();
  for (const ServiceAlarm& stood : alarms_.of(kRecordingNotTaken, {}))
    if (std::ranges::find(standing, stood) == standing.end()) alarms_.clear(stood.kind, stood.asset_id, stood.subject);
  for (const ServiceAlarm& one : standing) alarms_.raise(one);
}

void LayerRunner::note_alarms_of(const Message& output) {
  const auto said = options_.alarms_of_output ? options_.alarms_of_output(output) : std::nullopt;
  if (!said) return;
  for (const ServiceAlarm& stood : alarms_.of(said->kind, said->asset_id))
    if (std::ranges::find(said->standing, stood.subject, &ServiceAlarm::subject) == said->standing.end())
      alarms_.clear(stood.kind, stood.asset_id, stood.subject);
  for (const ServiceAlarm& one : said->standing)
    if (alarms_.raise(one))
      log_event(LogLevel::warn, one.kind, {{"asset", one.asset_id}, {"subject", one.subject}, {"error", one.text}});
}

void LayerRunner::tell_of_floods() {
  for (const Flood& flood : bus_.floods()) {
    const std::string text = "more comes of " + flood.source +
                             " than may come beside others; the rest is dropped: configure its assets, number its "
                             "blocks, or stop it";
    alarms_.raise({.kind = kFlood,
                   .asset_id = {},
                   .subject = flood.source,
                   .pst_id = {},
                   .text = text,
                   .since_ns = clock_.now().nanoseconds},
                  steady_now() + kFloodIsOver);
    log_event(LogLevel::warn, "flood", {{"source", flood.source}, {"dropped", std::to_string(flood.dropped)}});
  }
}

/// Nothing that a sender sends behind a gap counts, and it may not know (docs/topics.md, the contract of a sender).
void LayerRunner::tell_of_missing_blocks() {
  for (const StreamReader::Missing& gap : reader_->missing_of_senders()) {
    const std::string text = "blocks " + std::to_string(gap.first) + " to " + std::to_string(gap.last) +
                             " of this sender do not come, and what it sends after them is not taken: restart it " +
                             "under a new writer_id, with the tests that are not concluded";
    const bool is_new = alarms_.raise({.kind = kMissingBlocks,
                                       .asset_id = {},
                                       .subject = gap.writer_id,
                                       .pst_id = {},
                                       .text = text,
                                       .since_ns = clock_.now().nanoseconds},
                                      steady_now() + kBlocksCame);
    if (is_new) log_event(LogLevel::warn, "blocks are missing", {{"writer", gap.writer_id}, {"error", text}});
  }
}

/// A service that is deaf to another has no inputs waiting and looks idle. One alarm for each topic: strangers may
/// invent streams.
void LayerRunner::tell_of_missing_messages() {
  for (const Topic topic : inputs_) {
    const std::string name(name_of(topic));
    const auto missing = reader_->missing_of_services(name);
    const auto gap = std::ranges::find_if(missing, [this](const auto& one) { return strangers_.knows(one.writer_id); });
    if (gap == missing.end()) continue;
    const std::string text = "messages " + std::to_string(gap->first) + " to " + std::to_string(gap->last) + " of " +
                             gap->writer_id + " do not come, though it runs and is asked for them: give all services " +
                             "the same topics: in their configuration, restart them, and look at the network";
    const bool is_new = alarms_.raise({.kind = kMissingBlocks,
                                       .asset_id = {},
                                       .subject = name,
                                       .pst_id = {},
                                       .text = text,
                                       .since_ns = clock_.now().nanoseconds},
                                      steady_now() + kBlocksCame);
    if (is_new) log_event(LogLevel::error, "messages are missing", {{"topic", name}, {"error", text}});
  }
}

/// What comes a moment later is no news to anybody.
void LayerRunner::tell_of_waiting(const std::string& asset_id, const Layer& layer) {
  const std::vector<Refusal> waiting = layer.waiting();
  if (waiting.empty() && !acts_waiting_.contains(asset_id)) return;
  std::map<std::string, Alarms::Steady>& since = acts_waiting_[asset_id];
  for (const Refusal& one : waiting) {
    const std::string& act_id = header_of(one.input).message_id;
    if (steady_now() - since.try_emplace(act_id, steady_now()).first->second < options_.records_wait) continue;
    const bool is_new = alarms_.raise({.kind = kUnpublishedModel,
                                       .asset_id = asset_id,
                                       .subject = act_id,
                                       .pst_id = {},
                                       .text = visible(one.reason),
                                       .since_ns = clock_.now().nanoseconds});
    if (is_new) log_message(LogLevel::warn, "waits", one.input, {{"reason", one.reason}});
  }
  std::erase_if(since, [&](const auto& told) {
    const auto waits = [&](const Refusal& one) { return header_of(one.input).message_id == told.first; };
    if (std::ranges::any_of(waiting, waits)) return false;
    alarms_.clear(kUnpublishedModel, asset_id, told.first);
    return true;
  });
  if (since.empty()) acts_waiting_.erase(asset_id);
}

/// About once a second.
void LayerRunner::look_for_trouble() {
  tell_of_floods();
  tell_of_missing_blocks();
  tell_of_missing_messages();
  look_at_clock();
  for (RefusedTest& one : refused_tests_)  // refused while this machine's clock was ahead
    one.last = std::min(one.last, clock_.now());
  end_refused_tests([&](const RefusedTest& one) { return steady_now() - one.heard > options_.refusals_stand; });
  for (const std::string& alike : admission_.take_alike())
    if (reads_samples()) log_event(LogLevel::warn, "assets are alike in the ids of their tests", {{"error", alike}});
  note_strangers(strangers_.look(steady_now()));
  const auto refused = options_.refused_by_bus ? options_.refused_by_bus() : std::nullopt;
  if (refused)
    alarms_.raise({.kind = kRefusedRight,
                   .asset_id = {},
                   .subject = {},
                   .pst_id = {},
                   .text = *refused,
                   .since_ns = clock_.now().nanoseconds},
                  steady_now() + options_.strangers_stand);
  for (const ServiceAlarm& over : alarms_.expire(steady_now()))
    log_event(LogLevel::info, "alarm is over", {{"kind", over.kind}, {"subject", over.subject}});
}

}  // namespace sealwatch

// The runner's part in the stream protocol: sorting in what comes, asking for what is missing, sending again.
#include <algorithm>

#include "services/common/runtime/identity.hpp"
#include "services/common/runtime/layer_runner.hpp"
#include "services/common/runtime/log.hpp"

namespace sealwatch {
namespace {

/// For how long messages are sent again before new ones are looked at, and how many before the time is.
constexpr std::chrono::milliseconds kTurn{5};
constexpr std::chrono::milliseconds kTurnBesideLive{2};
/// What came so recently is followed by more.
constexpr std::chrono::milliseconds kLive{100};
constexpr std::uint64_t piece_of(Topic topic) { return topic == Topic::test_window ? 1 : 16; }
/// A topic that the bus has not taken for so long is worth a line: a reader is stuck, not only slow.
constexpr std::chrono::seconds kStuck{2};

constexpr std::chrono::seconds kLongestWithoutAsking{1};

/// Samples come many times a second; a test begins and ends, and is concluded from, once a month.
LogLevel level_of(const Message& message) {
  if (const auto* block = std::get_if<SampleBlock>(&message))
    return block->boundary == BlockBoundary::inside ? LogLevel::debug : LogLevel::info;
  return topic_of(message) == Topic::raw_samples ? LogLevel::debug : LogLevel::info;
}

double steady_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

bool contains(std::span<const Topic> topics, Topic topic) { return std::ranges::find(topics, topic) != topics.end(); }

}  // namespace

void LayerRunner::sort_in(BusItem item) {
  if (const auto stranger = StrangerWatch::unsayable(item)) return note_strangers({*stranger});
  std::visit([this](auto& content) { sort_in(std::move(content)); }, item);
}

void LayerRunner::sort_in(Message message) {
  const bool is_own =
      header_of(message).writer_id == journal_.writer_id();  // who writes a topic and reads it hears itself
  if (is_own || !contains(inputs_, topic_of(message)) || waits_for_acts(message)) return;
  note_strangers(strangers_.hear(message, std::chrono::steady_clock::now().time_since_epoch()));
  // Raw samples that are numbered are refused in their turn: their stream goes on.
  const bool in_its_turn = topic_of(message) == Topic::raw_samples && is_numbered(message);
  if (!in_its_turn && !strangers_.admits(message)) return;
  if (!is_numbered(message)) {
    ready_.push_back(std::move(message));
    return;
  }
  note_reused_number(message);
  for (Message& next : reader_->accept(std::move(message))) put_in_line(std::move(next));
}

/// A replacement that came under another system's id is kept under one of ours, and by earlier versions as it came.
Result<KnownInput> LayerRunner::known_as(const Message& message) {
  Message named = message;
  const auto asset = asset_of_input(header_of(message).message_id);
  if (!asset) return fail(asset.error());
  if (*asset && **asset != asset_of(message)) {
    if (Status kept = name_as_kept(named); !kept) return fail(kept.error());
    return journal_.known_input(named);
  }
  auto as_it_came = journal_.known_input(message);
  name_replacement(named);
  const bool same_name = header_of(named).message_id == header_of(message).message_id;
  if (!as_it_came || *as_it_came == KnownInput::same || same_name) return as_it_came;
  return journal_.known_input(named);
}

/// A number that was read and committed, with another message: the writer's journal was restored from a
/// backup, and its numbers count anew. (Of raw samples a refused one is not kept; who sends them is no journal.)
void LayerRunner::note_reused_number(const Message& message) {
  const Header& header = header_of(message);
  const Key stream{name_of(topic_of(message)), header.writer_id};
  const auto committed = committed_.find(stream);
  if (topic_of(message) == Topic::raw_samples || committed == committed_.end()) return;
  if (header.stream_sequence > committed->second || header.message_id.empty()) return;
  const auto known = known_as(message);
  if (!known) return;
  if (*known == KnownInput::same)
    reader_->note_known(message);
  else if (reader_->read_again(stream, steady_seconds()))
    start_anew(stream);
}

void LayerRunner::sort_in(const ServiceStatus& status) {
  if (status.writer_id == journal_.writer_id()) return;
  hear_name(status);
  keep_name(status);
  if (status.service == kind_->name()) note_rival(status);
  note_set_aside_elsewhere(status);
  retention_.hear(status, journal_.writer_id());
  hear_reader(status);
  hear_of_acts(status);
  hear_of_own_outputs(status);
  if (desk_) desk_->hear(status, std::chrono::steady_clock::now().time_since_epoch(), clock_.now());
  for (Message& next : reader_->note_start(status.writer_id, status.started_ns, steady_seconds()))
    put_in_line(std::move(next));
  for (const StreamPosition& written : status.written) {
    const auto topic = value_of<Topic>(written.topic);
    if (!topic || !contains(inputs_, *topic)) continue;
    if (reader_->note_written(written, steady_seconds())) start_anew({written.topic, written.writer_id});
  }
}

/// What was received of the stream and not committed is read again as well: its position must not count.
void LayerRunner::start_anew(const Key& stream) {
  committed_.erase(stream);
  const auto is_of_it = [&](const Message& message) {
    return is_numbered(message) && header_of(message).writer_id == stream.second &&
           name_of(topic_of(message)) == stream.first;
  };
  std::erase_if(ready_, is_of_it);
  std::erase_if(told_records_, [&](const auto& one) { return is_of_it(one.first); });
  log_event(LogLevel::warn, "writer was set back, reading its stream again from the start",
            {{"writer", stream.second}, {"topic", stream.first}});
}

void LayerRunner::sort_in(const ResendRequest& request) {
  const auto topic = value_of<Topic>(request.topic);
  if (request.writer_id != journal_.writer_id() || !topic || !journal_.written().contains(*topic)) return;
  // What waits in the outbox comes anyhow.
  const std::uint64_t sent = outbox_.first(*topic).value_or(journal_.written().at(*topic) + 1) - 1;
  // Strangers have one share, whatever names they invent.
  const std::string by = strangers_.knows(request.requested_by) ? request.requested_by : std::string();
  if (!resends_.add({*topic, request.first_sequence, request.last_sequence}, sent, by,
                    std::chrono::steady_clock::now()))
    return;
  log_event(LogLevel::info, "sending again",
            {{"topic", request.topic},
             {"first", std::to_string(request.first_sequence)},
             {"last", std::to_string(request.last_sequence)},
             {"for", request.requested_by}});
}

bool LayerRunner::publish(Message& message, std::string_view event) {
  header_of(message).writer_started_ns = started_ns_;
  stamp_clock(header_of(message), clock_reading_);
  const Topic topic = topic_of(message);
  const auto now = std::chrono::steady_clock::now();
  const auto refused_since = outbox_.refused_since(topic);
  const Status published = bus_.publish(message);
  outbox_.note(topic, published.has_value(), now);
  if (published) {
    log_message(event == "concluded" ? level_of(message) : LogLevel::debug, event, message);
    latest_.published(message);
    return true;
  }
  if (refused_since && now - *refused_since > kStuck) {
    note_error(published.error().describe());
    log_message(LogLevel::warn, "not published", message, {{"error", published.error().describe()}});
  }
  return false;
}

void LayerRunner::send_outbox() {
  outbox_.send(std::chrono::steady_clock::now(), [this](Message& message) { return publish(message, "concluded"); });
}

Status LayerRunner::serve_resends() {
  const auto begin = std::chrono::steady_clock::now();
  const auto whom = resends_.next(begin);
  if (!whom) return {};
  const bool beside_live = begin - last_work_ < kLive;
  bool goes_on = true;
  while (goes_on) {
    const auto range = resends_.take(*whom, piece_of(*resends_.next_topic(*whom)));
    if (outbox_.pauses(range->topic, begin)) break;  // who misses it asks again
    auto messages = journal_.outputs(range->topic, range->first, range->last, range->last - range->first + 1);
    if (!messages) return fail(messages.error());
    goes_on = std::ranges::all_of(*messages, [this](Message& message) { return publish(message, "sent again"); }) &&
              resends_.next_topic(*whom) &&
              std::chrono::steady_clock::now() - begin < (beside_live ? kTurnBesideLive : kTurn);
  }
  // At once: who joins between two turns would take a test of years ago for the last word.
  Status latest = publish_latest();
  resends_.note_sent(*whom, begin, std::chrono::steady_clock::now(), beside_live);
  if (heartbeat_) heartbeat_->beat_soon();  // readers of an older sealwatch wait for it after half a window
  return latest;
}

/// At the start, after older messages were sent again, and after tests that came late.
Status LayerRunner::publish_latest() {
  for (const auto& [key, sequence] : latest_.to_publish()) {
    const bool comes_anyhow = outbox_.first(key.first).value_or(sequence + 1) <= sequence;
    if (comes_anyhow || outbox_.pauses(key.first, std::chrono::steady_clock::now())) continue;
    auto latest = journal_.outputs(key.first, sequence, sequence, 1);
    if (!latest) return fail(latest.error());
    for (Message& message : *latest) (void)publish(message, "published again");  // again a second later, if not
  }
  return {};
}

void LayerRunner::send_requests() {
  // What waits on the bus is not missing; but under a flood something always waits.
  const auto now = std::chrono::steady_clock::now();
  if (!ready_.empty() || (full_since_ && now - asked_ < kLongestWithoutAsking)) return;
  asked_ = now;
  for (const ResendRequest& request : reader_->requests(steady_seconds())) {
    if (waits_for_acts_ && request.topic != name_of(Topic::act_record)) continue;
    log_event(LogLevel::info, "asking again",
              {{"topic", request.topic},
               {"writer", request.writer_id},
               {"first", std::to_string(request.first_sequence)},
               {"last", std::to_string(request.last_sequence)}});
    if (Status status = bus_.publish(request); !status)
      log_event(LogLevel::warn, "request not published", {{"error", status.error().describe()}});
  }
}

}  // namespace sealwatch

#include "services/common/runtime/layer_runner.hpp"

#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <thread>

#include "services/common/runtime/identity.hpp"
#include "services/common/runtime/log.hpp"

namespace sealwatch {
namespace {

using std::chrono::steady_clock;

/// Items taken from the bus at once.
constexpr std::size_t kBatch = 64;
/// Tests that may wait to be concluded from: each holds its samples, some hundred kilobytes.
constexpr std::size_t kMostLater = 4;
constexpr std::chrono::milliseconds kSecond{1000};

/// Samples come many times a second; a test begins and ends, and is concluded from, once a month.
LogLevel level_of(const Message& message) {
  if (const auto* block = std::get_if<SampleBlock>(&message))
    return block->boundary == BlockBoundary::inside ? LogLevel::debug : LogLevel::info;
  return topic_of(message) == Topic::raw_samples ? LogLevel::debug : LogLevel::info;
}

}  // namespace

LayerRunner::LayerRunner(Layer& layer, Bus& bus, Bus& heartbeat_bus, Journal& journal, const Clock& clock,
                         RunnerOptions options)
    : layer_(layer),
      bus_(bus),
      heartbeat_bus_(heartbeat_bus),
      journal_(journal),
      clock_(clock),
      options_(std::move(options)),
      later_([&bus] { bus.wake(); }) {}

Status LayerRunner::start() {
  // Subscribed first: what comes while the past is restored waits on the bus.
  if (Status status = bus_.subscribe_service_topics(); !status) return status;
  if (Status status = bus_.subscribe(layer_.inputs()); !status) return status;
  const auto positions = journal_.positions();
  if (!positions) return fail(positions.error());
  for (const StreamPosition& known : *positions) committed_[{known.topic, known.writer_id}] = known.sequence;
  reader_ = std::make_unique<StreamReader>(journal_.writer_id(), *positions, options_.streams);

  if (Status status = restore_past(); !status) return status;
  if (Status status = publish_latest(); !status) return status;
  started_ = steady_clock::now();
  ServiceStatus status;
  status.service = layer_.name();
  status.writer_id = journal_.writer_id();
  status.version = options_.version;
  status.started_ns = clock_.now().nanoseconds;
  status.process_id = ::getpid();
  status.state = "running";
  heartbeat_ = std::make_unique<Heartbeat>(heartbeat_bus_, clock_, status, options_.heartbeat);
  report_progress();
  return {};
}

Status LayerRunner::restore_past() {
  std::size_t restored = 0;
  std::map<Topic, std::uint64_t> sequence;  // outputs of a topic are numbered from 1 without a gap
  Status outputs = journal_.for_each_output([&](const Message& output) {
    layer_.restore(output);
    admission_.note(output);
    latest_.concluded(output, ++sequence[topic_of(output)]);
    replaying_ = header_of(output).replay;
    ++restored;
    return Status();
  });
  if (!outputs) return outputs;
  const std::uint64_t open = journal_.open_inputs();
  Status inputs = in_batch([&] {
    return journal_.for_each_open_input([&](const Message& input) {
      replaying_ = header_of(input).replay;
      admission_.note(input);
      return keep(completed(layer_.receive(without_stamps(input))), {});
    });
  });
  if (!inputs) return inputs;
  log_event(LogLevel::info, "started",
            {{"writer", journal_.writer_id()},
             {"restored_outputs", std::to_string(restored)},
             {"open_inputs", std::to_string(open)}});
  return {};
}

Status LayerRunner::run(const std::atomic<bool>& stop) {
  while (!stop) {
    const auto until_next_second =
        std::chrono::duration_cast<std::chrono::milliseconds>(last_second_ + kSecond - steady_clock::now());
    const auto timeout = std::clamp(until_next_second, std::chrono::milliseconds(1), kSecond);
    if (Status status = step(timeout); !status) return status;
  }
  return {};
}

Status LayerRunner::step(std::chrono::milliseconds timeout) {
  // A slow layer takes no more from the bus than it can soon conclude from, so that the bus holds the writers back.
  std::this_thread::sleep_until(last_work_ + options_.batch_pause);
  drained_ = false;
  if (later_.open() >= kMostLater) {
    later_.wait(timeout);
  } else if (ready_.size() < kBatch) {
    const bool work_waits = !ready_.empty() || !resends_.empty();
    std::vector<BusItem> items = bus_.receive(work_waits ? std::chrono::milliseconds(0) : timeout, kBatch);
    drained_ = items.size() < kBatch;
    for (BusItem& item : items) sort_in(std::move(item));
  }
  if (Status status = keep_what_is_done(); !status) return status;
  if (!ready_.empty() && later_.open() < kMostLater)
    if (Status status = in_batch([this] { return take_ready(); }); !status) return status;
  if (Status status = serve_resends(); !status) return status;
  send_requests();
  if (steady_clock::now() - last_second_ >= kSecond) {
    last_second_ = steady_clock::now();
    give_memory_back();
    if (Status status = let_time_pass(); !status) return status;
    if (resends_.empty())
      if (Status status = publish_latest(); !status) return status;
  }
  report_progress();
  return {};
}

Status LayerRunner::in_batch(const std::function<Status()>& work) {
  Status status = journal_.begin();
  if (status) status = work();
  if (status) status = journal_.commit();
  if (!status) {
    journal_.rollback();
    return status;
  }
  for (const auto& [stream, sequence] : uncommitted_) committed_[stream] = sequence;
  uncommitted_.clear();
  // Told before it is sent: a reader must never see a message that the heartbeat does not know yet.
  report_progress();
  for (const Message& message : std::exchange(outbox_, {}))
    if (!publish(message, "concluded")) break;
  return {};
}

Status LayerRunner::take_ready() {
  const auto begin = steady_clock::now();
  last_work_ = begin;
  holds_memory_ = true;
  do {
    Message message = std::move(ready_.front());
    ready_.pop_front();
    if (Status status = take(std::move(message)); !status) return status;
  } while (!ready_.empty() && later_.open() < kMostLater && steady_clock::now() - begin < options_.batch_time);
  return {};
}

Status LayerRunner::take(Message message) {
  Error problem;
  const auto value_of_result = [&problem]<class T>(Result<T> result) {
    if (!result) problem = result.error();
    return std::move(result).value_or(T());
  };
  const EarlierInputs earlier = {
      .has = [&](const std::string& known) { return value_of_result(journal_.has_input(known)); },
      .last_unnumbered =
          [&](Topic topic, const std::string& asset) {
            return value_of_result(journal_.last_unnumbered_input(topic, asset));
          }};
  const auto id = identify(message, earlier);
  if (!problem.rule.empty()) return fail(problem);
  if (is_numbered(message)) {
    const Header& header = header_of(message);
    const StreamPosition position{std::string(name_of(topic_of(message))), header.writer_id, header.stream_sequence};
    if (Status status = journal_.set_position(position); !status) return status;
    uncommitted_[{position.topic, position.writer_id}] = position.sequence;
  }
  if (!id) return {};
  header_of(message).message_id = *id;
  if (const auto refused = admission_.refusal(message, clock_.now())) {
    note_error(std::string(name_of(topic_of(message))) + " refused: " + *refused);
    log_message(LogLevel::warn, "refused", message, {{"reason", *refused}});
    // Not journaled: the id of a recording says nothing of its start time, and the corrected one comes under the same.
    if (topic_of(message) == Topic::raw_samples) return {};
    return journal_.add_input(message, clock_.now(), true);
  }
  admission_.note(message);
  replaying_ = header_of(message).replay;
  log_message(LogLevel::debug, "received", message);
  const Header stamped = header_of(message);
  message = without_stamps(std::move(message));
  Conclusion conclusion = layer_.receive(message);
  header_of(message) = stamped;
  const bool consumed = std::ranges::find(conclusion.consumed, *id) != conclusion.consumed.end();
  if (Status status = journal_.add_input(message, clock_.now(), consumed); !status) return status;
  return keep(std::move(conclusion), *id);
}

Status LayerRunner::keep(Conclusion conclusion, const std::string& input_id) {
  for (Message& output : conclusion.outputs) {
    auto kept = journal_.add_output(std::move(output), clock_.now());
    if (!kept) return fail(kept.error());
    if (!*kept) continue;
    latest_.concluded(**kept, header_of(**kept).stream_sequence);
    outbox_.push_back(std::move(**kept));
  }
  for (const std::string& id : conclusion.consumed) {
    if (id == input_id) continue;
    if (Status status = journal_.consume(id); !status) return status;
  }
  if (conclusion.later) later_.add(std::move(conclusion.later));
  return {};
}

Status LayerRunner::keep_what_is_done() {
  std::vector<Conclusion> done = later_.take_done();
  if (done.empty()) return {};
  last_work_ = steady_clock::now();
  holds_memory_ = true;
  return in_batch([&]() -> Status {
    for (Conclusion& conclusion : done)
      if (Status status = keep(std::move(conclusion), {}); !status) return status;
    return {};
  });
}

/// After a burst of work an idle service is as small as before it.
void LayerRunner::give_memory_back() {
  if (!holds_memory_ || steady_clock::now() - last_work_ < kSecond) return;
  ::malloc_trim(0);
  holds_memory_ = false;
}

Status LayerRunner::let_time_pass() {
  if (options_.local_inputs)
    for (Message& message : options_.local_inputs()) ready_.push_back(std::move(message));
  // A test is not overdue or lost while messages about it may be on their way.
  const bool up_to_date = drained_ && ready_.empty() && later_.open() == 0 && !reader_->is_behind();
  if (replaying_ || !up_to_date || steady_clock::now() - started_ < options_.settling) return {};
  Conclusion conclusion = layer_.tick(clock_.now());
  if (conclusion.outputs.empty() && conclusion.consumed.empty()) return {};
  return in_batch([&] { return keep(std::move(conclusion), {}); });
}

bool LayerRunner::publish(const Message& message, std::string_view event) {
  log_message(event == "concluded" ? level_of(message) : LogLevel::debug, event, message);
  const Status published = bus_.publish(message);
  if (published) {
    latest_.published(message);
    return true;
  }
  // Its readers will miss it, and what would have followed it, and ask for it: it is in the journal.
  latest_.give_up();
  note_error(published.error().describe());
  log_message(LogLevel::warn, "not published", message, {{"error", published.error().describe()}});
  return false;
}

// With its time: it stays in the status until another one comes.
void LayerRunner::note_error(const std::string& text) { last_error_ = format_utc(clock_.now()) + " " + text; }

void LayerRunner::report_progress() {
  if (!heartbeat_) return;  // the past is still being restored
  std::vector<StreamPosition> written;
  for (const auto& [topic, sequence] : journal_.written())
    written.push_back({std::string(name_of(topic)), journal_.writer_id(), sequence});
  std::vector<StreamPosition> received;
  for (const Key& stream : reader_->active()) {
    const auto position = committed_.find(stream);
    received.push_back({stream.first, stream.second, position == committed_.end() ? 0 : position->second});
  }
  heartbeat_->update([&](ServiceStatus& status) {
    // What the layer keeps as its memory waits for nothing; what runs in the other thread does.
    const std::uint64_t open = journal_.open_inputs();
    status.pending_inputs = std::max<std::uint64_t>(open - std::min<std::uint64_t>(layer_.held(), open), later_.open());
    status.pending_inputs += ready_.size();
    status.written = std::move(written);
    status.received = std::move(received);
    status.last_error = last_error_;
  });
}

}  // namespace sealwatch

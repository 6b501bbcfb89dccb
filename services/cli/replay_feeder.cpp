#include "services/cli/replay_feeder.hpp"

#include <algorithm>

#include "services/cli/terminal.hpp"
#include "services/common/runtime/stream_window.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::cli {
namespace {

std::uint64_t received_up_to(const ServiceStatus& status, const std::string& topic, const std::string& writer_id) {
  for (const StreamPosition& position : status.received)
    if (position.topic == topic && position.writer_id == writer_id) return position.sequence;
  return 0;
}

}  // namespace

ReplayFeeder::ReplayFeeder(std::string writer_id, std::function<std::vector<RawSamples>()> next_test,
                           std::size_t tests_ahead, double speed)
    : writer_id_(std::move(writer_id)), next_test_(std::move(next_test)), tests_ahead_(tests_ahead), speed_(speed) {}

std::size_t ReplayFeeder::tests_waiting() const {
  return static_cast<std::size_t>(std::count_if(waiting_.begin(), waiting_.end(), [](const RawSamples& block) {
    return block.boundary == BlockBoundary::end || block.boundary == BlockBoundary::whole;
  }));
}

bool ReplayFeeder::due(std::chrono::steady_clock::time_point now) const {
  if (speed_ <= 0.0 || unsent_.front().samples.time_s.empty()) return true;
  return std::chrono::duration<double>(now - test_started_).count() >= unsent_.front().samples.time_s.back() / speed_;
}

bool ReplayFeeder::publish(Bus& bus, const RawSamples& block) {
  const Status published = bus.publish(Message(block));
  not_taken_ = published ? std::string() : published.error().describe();
  return published.has_value();
}

void ReplayFeeder::repeat_unanswered(Bus& bus, std::chrono::steady_clock::time_point now) {
  constexpr std::chrono::seconds kUnanswered{3};  // several heartbeats
  if (waiting_.empty()) return;
  const std::pair<std::uint64_t, std::uint64_t> progress{waiting_.front().header.stream_sequence, last_sequence_};
  if (progress != progress_ || now - progressed_ < kUnanswered) {
    if (progress != progress_) progressed_ = now;
    progress_ = progress;
    return;
  }
  progressed_ = now;
  for (const RawSamples& block : waiting_)
    if (!publish(bus, block)) return;
}

void ReplayFeeder::feed(Bus& bus, std::chrono::steady_clock::time_point now) {
  repeat_unanswered(bus, now);
  while (waiting_.size() < stream_window("raw_samples")) {
    if (unsent_.empty()) {
      if (exhausted_ || tests_waiting() >= tests_ahead_) return;
      for (RawSamples& block : next_test_()) unsent_.push_back(std::move(block));
      exhausted_ = unsent_.empty();
      if (exhausted_) return;
      test_started_ = now;
    }
    if (!due(now)) return;
    unsent_.front().header.writer_id = writer_id_;
    unsent_.front().header.stream_sequence = last_sequence_ + 1;
    stamp_clock(unsent_.front().header, read_clock());
    if (!publish(bus, unsent_.front())) return;
    ++last_sequence_;
    waiting_.push_back(std::move(unsent_.front()));
    unsent_.pop_front();
  }
}

// The last error stands in the heartbeat, with its time, until another comes: what stood there before is of other
// tests.
void ReplayFeeder::note_refusal(const ServiceStatus& status) {
  if (last_sequence_ == 0) error_before_ = status.last_error;
  const std::string mark = " raw_samples refused: ";
  const std::size_t at = status.last_error.find(mark);
  if (at == std::string::npos || status.last_error == error_before_) return;
  const std::string reason = status.last_error.substr(at + mark.size());
  const std::string test = reason.substr(0, reason.find(": "));  // the rest names the time of refusal, block by block
  if (refused_.insert(test).second) refusals_.push_back(reason);
}

void ReplayFeeder::take(const ServiceStatus& status) {
  if (status.service != "data_acquisition") return;
  note_refusal(status);
  const std::uint64_t journaled = received_up_to(status, "raw_samples", writer_id_);
  while (!waiting_.empty() && waiting_.front().header.stream_sequence <= journaled) waiting_.pop_front();
}

void ReplayFeeder::take(const ResendRequest& request, Bus& bus) {
  if (request.writer_id != writer_id_ || request.topic != "raw_samples") return;
  for (const RawSamples& block : waiting_) {
    const std::uint64_t sequence = block.header.stream_sequence;
    if (sequence < request.first_sequence || sequence > request.last_sequence) continue;
    if (!publish(bus, block)) return;  // it asks again
  }
}

std::uint64_t Quiescence::backlog(const std::string& topic) const {
  std::uint64_t longest = 0;
  for (const auto& [service, topics] : inputs_of_) {
    const auto reader = last_.find(service);
    if (reader == last_.end() || std::ranges::find(topics, topic) == topics.end()) continue;
    for (const auto& [other, writer] : last_)
      for (const StreamPosition& written : writer.written)
        if (const std::uint64_t received = received_up_to(reader->second, topic, written.writer_id);
            written.topic == topic && written.sequence > received)
          longest = std::max(longest, written.sequence - received);
  }
  return longest;
}

bool Quiescence::keeps_up(std::uint64_t tests) const {
  return std::ranges::all_of(EnumNames<Topic>::kNames, [&](std::string_view topic) {
    const bool blocks = topic == "raw_samples" || topic == "sample_block";
    return backlog(std::string(topic)) < (blocks ? stream_window(topic) : tests);
  });
}

std::vector<StreamPosition> Quiescence::written(std::span<const Topic> topics) const {
  std::vector<StreamPosition> positions;
  for (const auto& [service, status] : last_)
    for (const StreamPosition& position : status.written)
      if (std::any_of(topics.begin(), topics.end(), [&](Topic topic) { return name_of(topic) == position.topic; }))
        positions.push_back(position);
  return positions;
}

std::vector<std::string> Quiescence::missing() const {
  std::vector<std::string> services;
  for (const auto& [service, topics] : inputs_of_)
    if (!last_.contains(service)) services.push_back(service);
  return services;
}

std::string Quiescence::explain() const {
  std::string text;
  for (const auto& [service, status] : last_)
    if (status.pending_inputs != 0)
      text::add_to_list(text, service + " has " + count_of(status.pending_inputs, "input") + " waiting");
  return text.empty() ? "no service has inputs waiting" : text;
}

void Quiescence::take(const ServiceStatus& status, Time now) {
  Waiting& waiting = waiting_.try_emplace(status.service, Waiting{status.pending_inputs, now, now}).first->second;
  waiting.fewest = std::min(waiting.fewest, status.pending_inputs);
  waiting.heard = now;
  ServiceStatus& last = last_[status.service];
  if (last.pending_inputs != status.pending_inputs) waiting.changed = now;
  last = status;
}

bool Quiescence::is_concluding(Time now) const {
  const auto is_heard = [&](const auto& service) {
    const auto found = waiting_.find(service.first);
    return found != waiting_.end() && now - found->second.heard < kSilent;
  };
  const auto has_inputs = [](const auto& service) { return service.second.pending_inputs > 0; };
  return std::ranges::all_of(inputs_of_, is_heard) && std::ranges::any_of(last_, has_inputs);
}

bool Quiescence::is_done(const ServiceStatus& status, Time now) const {
  const Waiting& waiting = waiting_.at(status.service);
  return status.pending_inputs == 0 || (status.pending_inputs <= waiting.fewest && now - waiting.changed >= kStill);
}

bool Quiescence::reached(const std::string& source_writer, std::uint64_t source_sequence, Time now) const {
  for (const auto& [service, topics] : inputs_of_) {
    const auto reader = last_.find(service);
    if (reader == last_.end() || !is_done(reader->second, now)) return false;
    for (const std::string& topic : topics) {
      if (topic == "raw_samples" && received_up_to(reader->second, topic, source_writer) < source_sequence)
        return false;
      for (const auto& [other, writer] : last_)
        for (const StreamPosition& written : writer.written)
          if (written.topic == topic && received_up_to(reader->second, topic, written.writer_id) < written.sequence)
            return false;
    }
  }
  return true;
}

}  // namespace sealwatch::cli

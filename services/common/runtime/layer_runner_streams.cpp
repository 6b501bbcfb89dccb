// The runner's part in the stream protocol: sorting in what comes, asking for what is missing, sending again.
#include <algorithm>

#include "services/common/runtime/identity.hpp"
#include "services/common/runtime/layer_runner.hpp"
#include "services/common/runtime/log.hpp"

namespace sealwatch {
namespace {

/// Messages sent again at once, before new ones are looked at.
constexpr std::size_t kPiece = 64;

double steady_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

bool contains(std::span<const Topic> topics, Topic topic) { return std::ranges::find(topics, topic) != topics.end(); }

}  // namespace

void LayerRunner::sort_in(BusItem item) {
  std::visit([this](auto& content) { sort_in(std::move(content)); }, item);
}

void LayerRunner::sort_in(Message message) {
  if (!contains(layer_.inputs(), topic_of(message))) return;
  if (!is_numbered(message)) {
    ready_.push_back(std::move(message));
    return;
  }
  for (Message& next : reader_->accept(std::move(message))) ready_.push_back(std::move(next));
}

void LayerRunner::sort_in(const ServiceStatus& status) {
  if (status.writer_id == journal_.writer_id()) return;
  if (status.service == layer_.name()) note_rival(status);
  for (const StreamPosition& written : status.written) {
    const auto topic = value_of<Topic>(written.topic);
    if (!topic || !contains(layer_.inputs(), *topic)) continue;
    if (reader_->note_written(written, steady_seconds()))
      log_event(LogLevel::warn, "writer was set back, reading its stream again from the start",
                {{"service", status.service}, {"writer", written.writer_id}, {"topic", written.topic}});
  }
}

/// Both conclude from the same messages, each under its own name: readers take what comes first, people see both.
void LayerRunner::note_rival(const ServiceStatus& rival) {
  if (rival.state != "running" || rival.writer_id == rival_) return;
  rival_ = rival.writer_id;
  last_error_ = "another " + rival.service + ", process " + std::to_string(rival.process_id) +
                ", runs in this domain; stop one of the two, or give it another domain";
  log_event(LogLevel::error, "not alone", {{"error", last_error_}, {"writer", rival.writer_id}});
}

void LayerRunner::sort_in(const ResendRequest& request) {
  const auto topic = value_of<Topic>(request.topic);
  if (request.writer_id != journal_.writer_id() || !topic || !journal_.written().contains(*topic)) return;
  log_event(LogLevel::info, "sending again",
            {{"topic", request.topic},
             {"first", std::to_string(request.first_sequence)},
             {"last", std::to_string(request.last_sequence)},
             {"for", request.requested_by}});
  resends_.add({*topic, std::max<std::uint64_t>(request.first_sequence, 1),
                std::min(request.last_sequence, journal_.written().at(*topic))});
}

Status LayerRunner::serve_resends() {
  const auto range = resends_.take(kPiece);
  if (!range) return {};
  const auto messages = journal_.outputs(range->topic, range->first, range->last, kPiece);
  if (!messages) return fail(messages.error());
  for (const Message& message : *messages) {
    if (publish(message, "sent again")) continue;
    resends_.clear();
    return {};
  }
  return resends_.empty() ? publish_latest() : Status();
}

/// At the start, after older messages were sent again, and after tests that came late.
Status LayerRunner::publish_latest() {
  for (const auto& [key, sequence] : latest_.to_publish()) {
    const auto latest = journal_.outputs(key.first, sequence, sequence, 1);
    if (!latest) return fail(latest.error());
    for (const Message& message : *latest)
      if (!publish(message, "published again")) return {};
  }
  return {};
}

void LayerRunner::send_requests() {
  if (!drained_ || !ready_.empty()) return;
  for (const ResendRequest& request : reader_->requests(steady_seconds())) {
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

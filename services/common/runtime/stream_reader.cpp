#include "services/common/runtime/stream_reader.hpp"

#include <algorithm>

namespace sealwatch {

StreamReader::StreamReader(std::string name, const std::vector<StreamPosition>& positions)
    : StreamReader(std::move(name), positions, Limits()) {}

StreamReader::StreamReader(std::string name, const std::vector<StreamPosition>& positions, Limits limits)
    : name_(std::move(name)), limits_(limits) {
  for (const StreamPosition& known : positions) {
    Stream& stream = streams_[{known.topic, known.writer_id}];
    stream.position = stream.last_position = stream.written = known.sequence;
  }
}

std::vector<Message> StreamReader::accept(Message message) {
  const Header& header = header_of(message);
  const std::uint64_t sequence = header.stream_sequence;
  Stream& stream = streams_[{std::string(name_of(topic_of(message))), header.writer_id}];
  stream.active = true;
  stream.written = std::max(stream.written, sequence);
  if (sequence <= stream.position) return {};
  if (sequence != stream.position + 1 && stream.held.size() >= limits_.held) return {};
  stream.held.try_emplace(sequence, std::move(message));
  std::vector<Message> in_order;
  while (!stream.held.empty() && stream.held.begin()->first == stream.position + 1) {
    in_order.push_back(std::move(stream.held.begin()->second));
    stream.held.erase(stream.held.begin());
    ++stream.position;
  }
  return in_order;
}

bool StreamReader::note_written(const StreamPosition& written, double now_s) {
  Stream& stream = streams_[{written.topic, written.writer_id}];
  stream.active = true;
  stream.wait_s = std::min(stream.wait_s, limits_.retry_s);  // the writer is there: no need to ask rarely
  if (written.sequence >= stream.position) {
    stream.set_back_since_s.reset();
    stream.written = std::max(stream.written, written.sequence);
    return false;
  }
  // Heartbeats travel apart from messages, so one may be a little older than what was read already.
  if (!stream.set_back_since_s) stream.set_back_since_s = now_s;
  if (now_s - *stream.set_back_since_s < limits_.set_back_s) return false;
  stream = Stream{.written = written.sequence, .held = {}, .active = true, .set_back_since_s = {}};
  return true;
}

bool StreamReader::is_due(Stream& stream, double now_s) const {
  if (stream.written <= stream.position) {
    stream.wait_s = 0.0;
    stream.last_position = stream.position;
    return false;
  }
  if (stream.position != stream.last_position || stream.wait_s == 0.0) {
    stream.last_position = stream.position;
    stream.waiting_since_s = now_s;
    stream.wait_s = limits_.patience_s;
    // The last request was answered in full and there is more.
    return stream.requested_until != 0 && stream.position >= stream.requested_until;
  }
  return now_s - stream.waiting_since_s >= stream.wait_s;
}

std::vector<ResendRequest> StreamReader::requests(double now_s) {
  std::vector<ResendRequest> requests;
  for (auto& [key, stream] : streams_) {
    if (!is_due(stream, now_s)) continue;
    const std::uint64_t gap_end = stream.held.empty() ? stream.written : stream.held.begin()->first - 1;
    stream.requested_until = std::min(gap_end, stream.position + limits_.window);
    stream.waiting_since_s = now_s;
    stream.wait_s =
        stream.wait_s < limits_.retry_s ? limits_.retry_s : std::min(2.0 * stream.wait_s, limits_.longest_retry_s);
    requests.push_back({.writer_id = key.second,
                        .topic = key.first,
                        .first_sequence = stream.position + 1,
                        .last_sequence = stream.requested_until,
                        .requested_by = name_});
  }
  return requests;
}

bool StreamReader::is_behind() const {
  return std::ranges::any_of(streams_, [](const auto& entry) { return entry.second.written > entry.second.position; });
}

std::vector<std::pair<std::string, std::string>> StreamReader::active() const {
  std::vector<Key> keys;
  for (const auto& [key, stream] : streams_)
    if (stream.active) keys.push_back(key);
  return keys;
}

}  // namespace sealwatch

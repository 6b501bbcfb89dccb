#include "services/common/runtime/stream_reader.hpp"

#include <iterator>

#include "services/common/runtime/stream_window.hpp"

namespace sealwatch {
namespace {

/// One that goes on beats once a second, or repeats what is not confirmed every 3 s.
constexpr double kSilent_s = 10.0;

}  // namespace

StreamReader::StreamReader(std::string name, const std::vector<StreamPosition>& positions)
    : StreamReader(std::move(name), positions, Limits()) {}

StreamReader::StreamReader(std::string name, const std::vector<StreamPosition>& positions, Limits limits)
    : name_(std::move(name)), limits_(limits) {
  for (const StreamPosition& known : positions) {
    Stream& stream = streams_[{known.topic, known.writer_id}];
    stream.position = stream.last_position = stream.waited_position = known.sequence;
    if (limits_.compares && is_of_a_service(known.topic)) stream.sure = known.sequence;
  }
}

StreamReader::Stream* StreamReader::stream_of(const Key& key) {
  if (const auto known = streams_.find(key); known != streams_.end()) return &known->second;
  if (streams_.size() >= limits_.streams) forget_strangers();
  return streams_.size() >= limits_.streams ? nullptr : &streams_[key];
}

/// Those of whom nothing was read, or nothing heard for long. What comes of them later is known by its ids.
void StreamReader::forget_strangers() {
  constexpr double kSweep_s = 1.0;
  if (now_s_ - swept_s_ < kSweep_s) return;
  swept_s_ = now_s_;
  std::erase_if(streams_, [this](const auto& entry) {
    const Stream& stream = entry.second;
    const double silent_s = now_s_ - stream.heard_s.value_or(0.0);
    return silent_s > (stream.position == 0 ? limits_.given_up_s : limits_.forgotten_s);
  });
}

std::vector<Message> StreamReader::accept(Message message) {
  const Header& header = header_of(message);
  const std::uint64_t sequence = header.stream_sequence;
  const Key key{name_of(topic_of(message)), header.writer_id};
  Stream* const stream = stream_of(key);
  if (stream == nullptr) return {};
  stream->heard_s = now_s_;
  hear_start(key, *stream, header.writer_started_ns);
  if (sequence <= stream->position) return hand_out(key, *stream);  // what waited until this one was compared
  stream->seen = std::max(stream->seen, sequence);
  const std::uint64_t most = std::min<std::uint64_t>(limits_.held, stream_window(key.first));
  if (sequence - stream->position > most + 1) {
    stream->beyond = stream->beyond == 0 ? sequence : std::min(stream->beyond, sequence);
    return {};
  }
  stream->held.insert_or_assign(sequence, std::move(message));
  return hand_out(key, *stream);
}

std::vector<Message> StreamReader::hand_out(const Key& key, Stream& stream) {
  std::vector<Message> in_order;
  const auto goes_on = [&](const Message& next) {
    if (!limits_.compares || !is_of_a_service(key.first)) return true;
    if (const std::int64_t started_ns = header_of(next).writer_started_ns; started_ns != 0)
      return started_ns == stream.checked_ns;
    return !stream.sure || stream.position - *stream.sure < stream_window(key.first) / 2;
  };
  while (!stream.held.empty() && stream.held.begin()->first == stream.position + 1 &&
         goes_on(stream.held.begin()->second)) {
    if (stream.position == 0) unread_waited_s_ = 0.0;
    in_order.push_back(std::move(stream.held.begin()->second));
    stream.held.erase(stream.held.begin());
    stream.beyond = 0;
    ++stream.position;
    if (!is_of_a_service(key.first) && stream.assets.size() < limits_.streams)
      stream.assets.insert(asset_of(in_order.back()));
  }
  return in_order;
}

bool StreamReader::note_written(const StreamPosition& written, double now_s) {
  now_s_ = now_s;
  Stream* const stream = stream_of({written.topic, written.writer_id});
  if (stream == nullptr) return false;
  stream->heard_s = now_s;
  stream->claimed = written.sequence;
  // The writer is there: no need to ask rarely, unless it is asked in vain.
  if (!is_given_up(*stream)) stream->wait_s = std::min(stream->wait_s, limits_.retry_s);
  if (written.sequence >= stream->position) {
    stream->set_back_since_s.reset();
    return false;
  }
  // Heartbeats travel apart from messages, so one may be a little older than what was read already.
  if (!stream->set_back_since_s) stream->set_back_since_s = now_s;
  if (now_s - *stream->set_back_since_s < limits_.set_back_s) return false;
  reread(*stream, now_s);
  return true;
}

void StreamReader::hear_start(const Key& key, Stream& stream, std::int64_t started_ns) const {
  if (!limits_.compares || !is_of_a_service(key.first) || started_ns == 0) return;
  if (started_ns == stream.checked_ns) forget_check(stream);  // a heartbeat was late, or forged
  begin_check(key, stream, started_ns);
}

void StreamReader::begin_check(const Key& key, Stream& stream, std::int64_t started_ns) const {
  if (started_ns == stream.checked_ns || started_ns == stream.checking_ns) return;
  const bool was_asked_for = stream.start_heard_s && now_s_ - *stream.start_heard_s < limits_.start_s;
  stream.checking_ns = started_ns;
  stream.check_last = stream.position;
  stream.check_first = stream.position - std::min(stream.position, stream_window(key.first)) + 1;
  stream.check_s = was_asked_for ? *stream.start_heard_s + limits_.start_s : now_s_;
  stream.check_wait_s = limits_.retry_s;
  if (!was_asked_for) stream.start_heard_s = now_s_;
  std::erase_if(stream.held, [](const auto& one) { return header_of(one.second).writer_started_ns == 0; });
  end_check(stream);
}

void StreamReader::end_check(Stream& stream) {
  if (stream.checking_ns == 0 || stream.check_first <= stream.check_last) return;
  if (stream.check_last < stream.position) {  // what was handed out of the start before, meanwhile
    stream.check_last = stream.position;
    return;
  }
  stream.checked_ns = stream.checking_ns;
  forget_check(stream);
}

void StreamReader::forget_check(Stream& stream) {
  if (stream.checking_ns == 0) return;
  stream.checking_ns = 0;
  stream.check_first = 1;
  stream.check_last = 0;
  std::erase_if(stream.held, [&](const auto& one) {  // of numbers that the writer may use again
    return header_of(one.second).writer_started_ns != stream.checked_ns;
  });
}

std::vector<Message> StreamReader::note_start(const std::string& writer_id, std::int64_t started_ns, double now_s) {
  now_s_ = now_s;
  std::vector<Message> waited;
  if (!limits_.compares) return waited;
  for (auto& [key, stream] : streams_) {
    if (key.second != writer_id || !is_of_a_service(key.first)) continue;
    begin_check(key, stream, started_ns);
    if (!stream.sure || stream.checking_ns == 0) stream.sure = stream.position;
    std::ranges::move(hand_out(key, stream), std::back_inserter(waited));
  }
  return waited;
}

void StreamReader::note_known(const Message& message) {
  const Header& header = header_of(message);
  const auto known = streams_.find({std::string(name_of(topic_of(message))), header.writer_id});
  if (known == streams_.end()) return;
  Stream& stream = known->second;
  hear_start(known->first, stream, header.writer_started_ns);
  if (header.writer_started_ns != 0 && header.writer_started_ns != stream.checking_ns) return;
  if (header.stream_sequence == stream.check_first && stream.check_first <= stream.check_last) ++stream.check_first;
  end_check(stream);
}

bool StreamReader::read_again(const Key& key, double now_s) {
  const auto known = streams_.find(key);
  if (known == streams_.end() || known->second.position == 0) return false;
  Stream& stream = known->second;
  if (stream.reread_s && now_s - *stream.reread_s < limits_.reread_s) return false;
  reread(stream, now_s);
  return true;
}

void StreamReader::reread(Stream& stream, double now_s) const {
  Stream fresh;
  fresh.claimed = stream.claimed;
  fresh.heard_s = fresh.reread_s = now_s;
  fresh.start_heard_s = stream.start_heard_s;
  fresh.sure = stream.sure ? std::optional<std::uint64_t>(0) : std::nullopt;
  stream = std::move(fresh);
}

bool StreamReader::is_due(Stream& stream, double now_s) const {
  if (stream.end() <= stream.position) {
    stream.wait_s = 0.0;
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

/// A word on how far a stream goes that comes and goes is waited for no longer than one that stays. Whoever was
/// stopped, or read its past, did not wait: what came meanwhile is still to be taken from the bus.
void StreamReader::note_waiting(double now_s) {
  const double since_last_s = looked_s_ ? std::min(now_s - *looked_s_, limits_.longest_look_s) : 0.0;
  looked_s_ = now_s;
  bool waits_for_unread = false;
  for (auto& [key, stream] : streams_) {
    if (stream.position != stream.waited_position) {
      stream.waited_position = stream.position;
      stream.waited_s = 0.0;
    } else if (stream.end() > stream.position) {
      stream.waited_s += since_last_s;
      waits_for_unread = waits_for_unread || stream.position == 0;
    }
    if (is_given_up(stream)) stream.seen = stream.held.empty() ? stream.position : stream.held.rbegin()->first;
  }
  if (waits_for_unread) unread_waited_s_ += since_last_s;
}

bool StreamReader::is_check_due(Stream& stream, double now_s) const {
  if (stream.check_first > stream.check_last || stream.end() < stream.check_first || now_s < stream.check_s)
    return false;
  stream.check_s = now_s + stream.check_wait_s;
  stream.check_wait_s = std::min(2.0 * stream.check_wait_s, limits_.longest_retry_s);
  return true;
}

ResendRequest StreamReader::request(const Key& key, std::uint64_t first, std::uint64_t last) const {
  return {.writer_id = key.second,
          .topic = key.first,
          .first_sequence = first,
          .last_sequence = last,
          .requested_by = name_};
}

std::vector<ResendRequest> StreamReader::requests(double now_s) {
  now_s_ = now_s;
  note_waiting(now_s);
  std::vector<ResendRequest> requests;
  for (auto& [key, stream] : streams_) {
    if (requests.size() >= limits_.requests) break;
    if (is_check_due(stream, now_s)) requests.push_back(request(key, stream.check_first, stream.check_last));
    if (!is_due(stream, now_s)) continue;
    const bool waits_for_a_heartbeat = !stream.held.empty() && stream.held.begin()->first == stream.position + 1;
    if (waits_for_a_heartbeat) continue;
    const std::uint64_t gap_end = stream.held.empty() ? stream.end() : stream.held.begin()->first - 1;
    const std::uint64_t most = std::min(limits_.window, stream_window(key.first));
    stream.requested_until = stream.position + std::min(gap_end - stream.position, most);
    stream.waiting_since_s = now_s;
    stream.wait_s =
        stream.wait_s < limits_.retry_s ? limits_.retry_s : std::min(2.0 * stream.wait_s, limits_.longest_retry_s);
    requests.push_back(request(key, stream.position + 1, stream.requested_until));
  }
  return requests;
}

bool StreamReader::is_behind(const Stream& stream) const {
  if (stream.end() <= stream.position || is_given_up(stream)) return false;
  return stream.position > 0 || unread_waited_s_ < limits_.given_up_s;
}

bool StreamReader::is_behind() const {
  return std::ranges::any_of(streams_, [this](const auto& entry) { return is_behind(entry.second); });
}

bool StreamReader::is_behind(const std::string& asset_id) const {
  return std::ranges::any_of(streams_, [&](const auto& entry) {
    const Stream& stream = entry.second;
    return is_behind(stream) && (stream.assets.empty() || stream.assets.contains(asset_id));
  });
}

bool StreamReader::is_behind_on(std::string_view topic) const {
  return std::ranges::any_of(streams_,
                             [&](const auto& entry) { return entry.first.first == topic && is_behind(entry.second); });
}

std::vector<StreamReader::Missing> StreamReader::missing_of_services(std::string_view topic) const {
  std::vector<Missing> missing;
  for (const auto& [key, stream] : streams_)
    if (key.first == topic && is_of_a_service(topic) && is_given_up(stream) && stream.end() > stream.position &&
        now_s_ - stream.heard_s.value_or(-kSilent_s) < kSilent_s)
      missing.push_back({key.second, stream.position + 1, stream.end()});
  return missing;
}

std::vector<StreamReader::Missing> StreamReader::missing_of_senders() const {
  std::vector<Missing> missing;
  for (const auto& [key, stream] : streams_) {
    const std::uint64_t next = stream.held.empty() ? stream.beyond : stream.held.begin()->first;
    if (!is_of_a_service(key.first) && is_given_up(stream) && next > 0 &&
        now_s_ - stream.heard_s.value_or(0.0) < kSilent_s)
      missing.push_back({key.second, stream.position + 1, next - 1});
  }
  return missing;
}

std::vector<StreamReader::Key> StreamReader::active() const {
  std::vector<Key> keys;
  for (const auto& [key, stream] : streams_)
    if (stream.position > 0 && stream.heard_s && now_s_ - *stream.heard_s < limits_.forgotten_s) keys.push_back(key);
  return keys;
}

}  // namespace sealwatch

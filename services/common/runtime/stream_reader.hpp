// The reading side of the stream protocol (message/service.hpp): each writer's stream in order, without gaps and
// without doubles, whatever the bus delivers.
//
// A message beyond a gap is held back until the gap is filled. A gap, or a stream whose writer says that it goes
// further, is asked for again: after `patience_s` without progress, then every `retry_s`, more and more rarely while
// the writer is silent, at most `window` messages at a time (so that a slow reader is not flooded).
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sealwatch/message/service.hpp"
#include "sealwatch/message/topics.hpp"

namespace sealwatch {

class StreamReader {
 public:
  struct Limits {
    std::size_t held = 256;  ///< messages held back beyond a gap, for each stream; more are dropped and asked for
    std::uint64_t window = 256;
    double patience_s = 0.3;
    double retry_s = 1.0;
    double longest_retry_s = 16.0;
    double set_back_s = 5.0;  ///< a writer that stays behind what was read of it for so long lost its journal's end
  };

  /// `name` signs the requests; reading continues behind `positions`.
  StreamReader(std::string name, const std::vector<StreamPosition>& positions, Limits limits);
  StreamReader(std::string name, const std::vector<StreamPosition>& positions);

  /// Takes a numbered message and returns those that are next in order now, none to all that were held.
  [[nodiscard]] std::vector<Message> accept(Message message);
  /// Takes note of how far a writer's stream goes. True when the writer was set back (its journal was restored from a
  /// backup): the stream is then read again from its start, as known messages are recognised by their ids.
  bool note_written(const StreamPosition& written, double now_s);
  /// What to ask for now. Call it only when nothing is waiting to be received: what waits is not missing.
  [[nodiscard]] std::vector<ResendRequest> requests(double now_s);
  /// Whether a stream is known to go further than it was read.
  [[nodiscard]] bool is_behind() const;
  /// Streams that were heard of since the start.
  [[nodiscard]] std::vector<std::pair<std::string, std::string>> active() const;

 private:
  using Key = std::pair<std::string, std::string>;  // topic, writer id
  struct Stream {
    std::uint64_t position = 0;  ///< last one handed out
    std::uint64_t written = 0;   ///< last one that is known to exist
    std::map<std::uint64_t, Message> held;
    bool active = false;
    std::uint64_t last_position = 0;    ///< at the last look, to notice progress
    std::uint64_t requested_until = 0;  ///< end of the last request
    double waiting_since_s = 0.0;       ///< last progress or request
    double wait_s = 0.0;                ///< before the next request; 0: not waiting
    std::optional<double> set_back_since_s;
  };
  [[nodiscard]] bool is_due(Stream& stream, double now_s) const;

  std::string name_;
  Limits limits_;
  std::map<Key, Stream> streams_;
};

}  // namespace sealwatch

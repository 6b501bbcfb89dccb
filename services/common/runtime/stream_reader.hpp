// The reading side of the stream protocol (message/service.hpp): each writer's stream in order, without gaps and
// without doubles, whatever the bus delivers.
//
// A message beyond a gap is held back until the gap is filled. A gap, or a stream whose writer says that it goes
// further, is asked for again: after `patience_s` without progress, then every `retry_s`, more and more rarely while
// the writer is silent, at most `window` messages at a time (so that a slow reader is not flooded).
//
// Nothing that is said of a stream is believed for ever: not how far it goes (a forged word, a writer that died in a
// gap: after `given_up_s` without progress it is asked for, but not waited for), and not that it is the stream that was
// read before (a writer whose journal was restored uses its numbers again for other messages: whenever a writer starts,
// the last messages that were read of it are asked for again, and whoever knows ids and numbers compares: read_again).
// Each message says when its writer started (Header::writer_started_ns): of a start that has not been compared nothing
// is handed out, so that the comparison always reaches back to what was read before it, whoever is killed meanwhile. Of
// writers that do not say so (an older sealwatch) half a window is handed out between two heartbeats.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
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
    double set_back_s = 5.0;      ///< a writer that stays behind what was read of it for so long lost its journal's end
    double given_up_s = 60.0;     ///< a stream that has not moved for so long is not waited for
    double forgotten_s = 600.0;   ///< a writer that was not heard for so long is not spoken of
    double longest_look_s = 2.0;  ///< of the time between two looks at what is missing, so much counts as waiting
    double reread_s = 60.0;       ///< between two times that a stream is read from its start
    std::size_t streams = 4096;   ///< known at once: strangers' words about more are passed over
    std::size_t requests = 64;    ///< at a time
    double start_s = 1.0;         ///< between two starts of a writer for which what was read last is asked for
    bool compares = true;         ///< whether its owner compares ids: note_known, read_again
  };
  using Key = std::pair<std::string, std::string>;  // topic, writer id

  /// `name` signs the requests; reading continues behind `positions`.
  StreamReader(std::string name, const std::vector<StreamPosition>& positions, Limits limits);
  StreamReader(std::string name, const std::vector<StreamPosition>& positions);

  /// Takes a numbered message and returns those that are next in order now, none to all that were held.
  [[nodiscard]] std::vector<Message> accept(Message message);
  /// Takes note of how far a writer's stream goes. True when the writer was set back (its journal was restored from a
  /// backup): the stream is then read again from its start, as known messages are recognised by their ids.
  bool note_written(const StreamPosition& written, double now_s);
  /// Takes note of a heartbeat and of when its writer started; returns what waited for this.
  [[nodiscard]] std::vector<Message> note_start(const std::string& writer_id, std::int64_t started_ns, double now_s);
  /// A message came again that is committed, and known under this number.
  void note_known(const Message& message);
  /// A number that was read before came with another message: the stream is read again from its start. False
  /// when it has just been.
  bool read_again(const Key& stream, double now_s);
  /// What to ask for now. Call it only when nothing is waiting to be received: what waits is not missing.
  [[nodiscard]] std::vector<ResendRequest> requests(double now_s);
  /// Whether a stream that may be about this asset is known to go further than it was read, and moves. Services write
  /// about all assets, a sender about those that it has written about. Streams of which nothing was read, whose writers
  /// anybody can make up, are waited for `given_up_s` all together, until something is read of one.
  [[nodiscard]] bool is_behind(const std::string& asset_id) const;
  /// Whether any stream is.
  [[nodiscard]] bool is_behind() const;
  /// Whether any of the topic is.
  [[nodiscard]] bool is_behind_on(std::string_view topic) const;
  /// What a writer that is heard was asked for in vain.
  struct Missing {
    std::string writer_id;
    std::uint64_t first = 0, last = 0;
  };
  /// Of senders: blocks before others of theirs that wait.
  [[nodiscard]] std::vector<Missing> missing_of_senders() const;
  /// Of services: messages that their heartbeats say they have written.
  [[nodiscard]] std::vector<Missing> missing_of_services(std::string_view topic) const;
  /// Streams of which something was read and that were heard of lately.
  [[nodiscard]] std::vector<Key> active() const;

 private:
  struct Stream {
    std::uint64_t position = 0;  ///< last one handed out
    std::uint64_t claimed = 0;   ///< how far it goes by its writer's last word
    std::uint64_t seen = 0;      ///< the highest number that came
    std::uint64_t beyond = 0;    ///< the lowest that was too far ahead to be held, since the last progress; 0: none
    std::map<std::uint64_t, Message> held;
    std::optional<double> heard_s;    ///< since the start
    std::uint64_t last_position = 0;  ///< at the last look, to notice progress
    std::uint64_t waited_position = 0;
    double waited_s = 0.0;              ///< how long it was behind without progress, all together
    std::set<std::string> assets;       ///< of a sender: what was read of it was about these
    std::uint64_t requested_until = 0;  ///< end of the last request
    double waiting_since_s = 0.0;       ///< last progress or request
    double wait_s = 0.0;                ///< before the next request; 0: not waiting
    std::optional<double> set_back_since_s;
    std::optional<double> reread_s;       ///< when it was last read from its start
    std::int64_t checked_ns = 0;          ///< start of its writer whose messages are handed out
    std::int64_t checking_ns = 0;         ///< one that is being compared; 0: none
    std::optional<double> start_heard_s;  ///< when that one was heard of
    std::optional<std::uint64_t> sure;    ///< of messages that do not say their start: read up to here of a checked one
    /// What had been read last when its writer or this reader was new; it is to come again, in order. Empty: it has.
    std::uint64_t check_first = 1;
    std::uint64_t check_last = 0;
    double check_s = 0.0;  ///< when to ask for it
    double check_wait_s = 0.0;

    [[nodiscard]] std::uint64_t end() const { return std::max(claimed, seen); }
  };
  /// Null for a stranger's stream too many.
  [[nodiscard]] Stream* stream_of(const Key& key);
  void forget_strangers();
  /// A message says when its writer started, 0 where it does not.
  void hear_start(const Key& key, Stream& stream, std::int64_t started_ns) const;
  /// The writer of this stream may have started anew.
  void begin_check(const Key& key, Stream& stream, std::int64_t started_ns) const;
  /// Compared, where all of it was.
  static void end_check(Stream& stream);
  static void forget_check(Stream& stream);
  [[nodiscard]] bool is_given_up(const Stream& stream) const { return stream.waited_s >= limits_.given_up_s; }
  void note_waiting(double now_s);
  [[nodiscard]] bool is_behind(const Stream& stream) const;
  void reread(Stream& stream, double now_s) const;
  [[nodiscard]] std::vector<Message> hand_out(const Key& key, Stream& stream);
  [[nodiscard]] bool is_due(Stream& stream, double now_s) const;
  [[nodiscard]] bool is_check_due(Stream& stream, double now_s) const;
  [[nodiscard]] ResendRequest request(const Key& key, std::uint64_t first, std::uint64_t last) const;

  std::string name_;
  Limits limits_;
  double now_s_ = 0.0;  ///< at the last call that said it
  double swept_s_ = 0.0;
  std::optional<double> looked_s_;  ///< last look at what is missing
  double unread_waited_s_ = 0.0;    ///< how long streams were behind of which nothing was read
  std::map<Key, Stream> streams_;
};

}  // namespace sealwatch

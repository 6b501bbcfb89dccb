// The writing side of the stream protocol: what others asked to have again, served a bounded number at a time.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "sealwatch/message/topics.hpp"

namespace sealwatch {

class ResendQueue {
 public:
  struct Range {
    Topic topic = Topic::raw_samples;
    std::uint64_t first = 0;
    std::uint64_t last = 0;
    friend bool operator==(const Range&, const Range&) = default;
  };

  /// Adds what is not waiting already: several readers that miss the same messages are served once.
  void add(Range wanted);
  /// The next at most `most` messages to send, topics in turn.
  [[nodiscard]] std::optional<Range> take(std::uint64_t most);
  /// Forgets what waits; whoever still misses it asks again.
  void clear() { waiting_.clear(); }
  [[nodiscard]] bool empty() const { return waiting_.empty(); }

 private:
  std::deque<Range> waiting_;
};

}  // namespace sealwatch

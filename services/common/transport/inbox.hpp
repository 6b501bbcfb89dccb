// What has arrived at a bus and was not asked for yet, bounded by topic. Beyond a topic's limit what comes again anyhow
// is left out: numbered messages, as their writer has them in its journal and the reader asks for what it misses; and
// heartbeats and requests, which are repeated. A message that is not numbered is kept up to twice the limit, then left
// in DDS, which makes its sender wait.
#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <mutex>
#include <vector>

#include "sealwatch/port/bus.hpp"
#include "services/common/transport/signal.hpp"
#include "services/common/transport/topic_types.hpp"

namespace sealwatch::transport {

class Inbox {
 public:
  Signal signal;     ///< something arrived
  std::mutex mutex;  ///< for all that follows

  [[nodiscard]] bool empty() const { return items_.empty(); }
  /// Whether nothing more of that topic should be taken from DDS.
  [[nodiscard]] bool is_full(std::size_t topic, std::size_t limit) const { return waiting_[topic] >= 2 * limit; }
  /// Adds it, or leaves it out.
  void put(BusItem item, std::size_t limit);
  /// The oldest, at most `most`.
  [[nodiscard]] std::vector<BusItem> take(std::size_t most);

 private:
  std::deque<BusItem> items_;
  std::array<std::size_t, kTopicCount> waiting_{};  ///< by topic, as topic_types() counts them
};

}  // namespace sealwatch::transport

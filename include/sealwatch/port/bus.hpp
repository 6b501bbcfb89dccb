// The bus between processes, as layers' runners see it. Implemented over Cyclone DDS in services/common/transport and
// in memory (tests/unit/port/in_memory_bus.hpp); one contract suite tests both.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "sealwatch/core/result.hpp"
#include "sealwatch/message/topics.hpp"

namespace sealwatch {

using BusItem = std::variant<Message, ServiceStatus, ResendRequest>;

/// What was dropped of somebody who sent more than a stranger may, or than its share beside others.
struct Flood {
  std::string source;  ///< who it says it is, else the topic
  std::uint64_t dropped = 0;
};

/// One participant's view of the bus. Not thread-safe but for wake(): one thread publishes and receives (the heartbeat
/// thread of a daemon owns a second Bus).
///
/// Contract: messages of one publisher on one topic arrive in order, of raw samples that are not numbered those about
/// one asset; between publishers and subscribers that are connected nothing is lost of what is not numbered, but what is
/// told as a flood, and of what is numbered (Header::stream_sequence) and of service topics only what a subscriber that
/// does not call receive cannot hold; a late subscriber gets the last message of every asset of every publisher still
/// alive; a publisher's end removes nothing that was delivered. A publish never waits for longer than 20 ms. An Error
/// says that the bus did not take the message now: it may have reached some of its readers; publish it again.
class Bus {
 public:
  virtual ~Bus() = default;
  /// From now on messages of these topics are received. Service topics are separate: see subscribe_service_topics.
  [[nodiscard]] virtual Status subscribe(std::span<const Topic> topics) = 0;
  [[nodiscard]] virtual Status subscribe_service_topics() = 0;
  /// Connects those who will hear messages of these topics, and resend requests, before the first of them is published:
  /// who is connected only by the first message misses it, and has to ask for it.
  [[nodiscard]] virtual Status announce(std::span<const Topic> topics) {
    (void)topics;
    return {};
  }
  [[nodiscard]] virtual Status publish(const Message& message) = 0;
  [[nodiscard]] virtual Status publish(const ServiceStatus& status) = 0;
  [[nodiscard]] virtual Status publish(const ResendRequest& request) = 0;
  /// Waits until something arrives, wake() is called or the time is over, and takes at most `most` items.
  [[nodiscard]] virtual std::vector<BusItem> receive(std::chrono::milliseconds timeout, std::size_t most = 64) = 0;
  /// Whether the last receive, though it gave fewer than it might, left something that the next may give at once.
  [[nodiscard]] virtual bool has_more() { return false; }
  /// Makes a receive that waits in another thread (or a signal handler) return.
  virtual void wake() = 0;
  /// What was dropped since the last call.
  [[nodiscard]] virtual std::vector<Flood> floods() { return {}; }
};

}  // namespace sealwatch

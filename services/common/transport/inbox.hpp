// What has arrived at a bus and was not asked for yet, bounded, and fair between those who sent it: each DDS writer has
// a queue of its own, and they take turns, so that whoever sends a flood waits behind itself alone.
//
//   numbered        beyond a topic's limit left out of whoever has more than its share waiting: their writer has them
//                   in its journal, and the reader asks for what it misses
//   service status  only a writer's last word about each service waits
//   requests        left out as numbered messages are: they are repeated
//   not numbered    kept up to twice the topic's limit, then left in DDS, which makes its sender wait. But DDS delivers
//                   in one line: where others send on that topic too, they would wait with it. So then what is beyond
//                   its sender's share is dropped and counted. Of one asset a take gives no more than its share, as all
//                   that is taken at once is waited for at once
//   raw samples     that are not numbered: the assets of a writer take turns too, as a gateway has many, and beyond the
//                   writer's share those are dropped first of which more than their part of it waits. Assets that are
//                   not configured count as one; of each that is, one block is kept, however large the fleet
//   of strangers    that is, not numbered, about no configured asset and from no configured sender: so many a second are
//                   taken, whoever sends them, and so many wait; the rest is dropped and counted
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "sealwatch/port/bus.hpp"
#include "services/common/transport/signal.hpp"
#include "services/common/transport/topic_types.hpp"

namespace sealwatch::transport {

class Inbox {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Writer = std::uint64_t;  ///< as DDS tells writers apart
  /// A stranger's actuator at 200 Hz sends 20 blocks a second.
  static constexpr std::size_t kStrangersASecond = 200;
  static constexpr std::size_t kMostOfStrangers = 1024;
  static constexpr std::size_t kMostStatuses = 16;  ///< of one writer
  /// Who was heard so long ago sends no test any more: acquisition then closes it as cut.
  static constexpr std::chrono::seconds kForgotten{60};

  Signal signal;     ///< something arrived
  std::mutex mutex;  ///< for all that follows

  /// Who is no stranger. Nobody is one where there are no assets.
  void know(std::set<std::string> assets, std::set<std::string> senders);

  [[nodiscard]] bool empty() const { return turns_.empty(); }
  /// Whether anything waits that the next take may give: strangers' messages are not counted.
  [[nodiscard]] bool has_more() const { return !empty() && queues_.size() > strangers_queues_; }
  /// Whether strangers' messages wait until more of them may be taken.
  [[nodiscard]] bool strangers_wait() const { return strangers_waiting_ > 0; }
  /// Whether nothing more of that topic should be taken from DDS.
  [[nodiscard]] bool is_full(std::size_t topic, std::size_t limit, Time now);
  /// Adds it, or leaves it out.
  void put(Writer writer, std::unique_ptr<BusItem> item, std::size_t limit, Time now);
  /// At most `most`, writers in turn; those of one writer, of raw samples those of one of its assets, in the order in
  /// which they came. Fewer where more would be beyond an asset's share: at least one, where any may be taken.
  [[nodiscard]] std::vector<BusItem> take(std::size_t most, Time now);
  /// What was dropped since the last call.
  [[nodiscard]] std::vector<Flood> floods();

 private:
  using Key = std::pair<bool, Writer>;                ///< whether it is a stranger's
  using Line = std::deque<std::unique_ptr<BusItem>>;  ///< in the order in which they came
  /// What waits of one writer, in lines that take turns.
  class Queue {
   public:
    [[nodiscard]] bool empty() const { return turns_.empty(); }
    [[nodiscard]] std::size_t size() const { return size_; }
    [[nodiscard]] std::size_t lines() const { return turns_.size(); }
    [[nodiscard]] std::size_t size_of(const std::string& line) const;
    [[nodiscard]] Line* find(const std::string& line);
    void add(const std::string& line, std::unique_ptr<BusItem> item);
    /// Turns to the next line whose first may be taken; false where there is none.
    [[nodiscard]] bool turn_to(const std::function<bool(const BusItem&)>& may_be_taken);
    /// The first of the line whose turn it is.
    [[nodiscard]] std::unique_ptr<BusItem> take();

   private:
    std::map<std::string, Line> lines_;  ///< none is empty
    std::deque<std::string> turns_;      ///< each line once
    std::size_t size_ = 0;
  };
  [[nodiscard]] bool is_strangers(const BusItem& item) const;
  /// Whether that many wait, and in this queue more than its writer's share of them, and in this line more than its part.
  [[nodiscard]] bool is_beyond_share(const Queue& queue, const std::string& line, std::size_t topic,
                                     std::size_t limit) const;
  /// Which of its writer's lines it stands in: the order of raw samples counts within an asset alone.
  [[nodiscard]] std::string line_of(const BusItem& item) const;
  [[nodiscard]] bool is_left_out(const Queue& queue, std::size_t topic, std::size_t limit) const;
  /// Whether one writer at most sends on that topic.
  [[nodiscard]] bool is_alone(std::size_t topic, Time now);
  void note_heard(Writer writer, const BusItem& item, std::size_t topic, Time now);
  void drop(const BusItem& item);
  [[nodiscard]] std::unique_ptr<BusItem> take_one(const Key& key);
  /// How many not numbered messages of one asset make its share of `most`.
  [[nodiscard]] std::size_t share_of_asset(std::size_t topic, std::size_t most, Time now);
  using Shares = std::map<std::pair<std::size_t, std::string>, std::size_t>;  ///< taken, by topic and asset
  /// Whether it may be taken: then it is counted in `taken`.
  [[nodiscard]] bool is_in_share(const BusItem& item, Shares& taken, std::size_t most, Time now);

  std::set<std::string> assets_;
  std::set<std::string> senders_;
  std::map<Key, Queue> queues_;                     ///< none is empty
  std::deque<Key> turns_;                           ///< each queue once
  std::array<std::size_t, kTopicCount> waiting_{};  ///< by topic, as topic_types() counts them; without strangers'
  std::array<std::size_t, kTopicCount> writers_{};  ///< queues by topic, likewise
  std::array<std::size_t, kTopicCount> lines_{};    ///< and their lines
  std::array<std::map<std::string, Time>, kTopicCount> heard_{};         ///< by topic, the last time; without strangers
  std::array<std::map<std::string, Time>, kTopicCount> heard_assets_{};  ///< likewise, of what is not numbered
  std::size_t strangers_waiting_ = 0;
  std::size_t strangers_queues_ = 0;
  double strangers_may_ = 0.0;  ///< how many may be taken now
  Time strangers_looked_{};
  std::map<std::string, std::uint64_t> dropped_;  ///< by who sent it
};

}  // namespace sealwatch::transport

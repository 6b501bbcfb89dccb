// Feeds recorded tests to data acquisition as raw_samples, a few tests and at most a stream's window of blocks ahead of
// what it has safely journaled, and sends again what it asks for: a data acquisition killed at any moment loses
// nothing.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sealwatch/message/topics.hpp"
#include "sealwatch/port/bus.hpp"

namespace sealwatch::cli {

class ReplayFeeder {
 public:
  /// `next_test` gives the blocks of the next test, none when there are no more. `speed` is recorded seconds per
  /// second; 0: as fast as data acquisition journals, at most `tests_ahead` tests before it.
  ReplayFeeder(std::string writer_id, std::function<std::vector<RawSamples>()> next_test, std::size_t tests_ahead,
               double speed);

  /// Publishes what may be published at `now`; again what data acquisition has not journaled for some seconds. It asks
  /// for what is missing before a block that it has, but of the last one, lost as it died, nothing tells it. What the
  /// bus does not take stays for the next call.
  void feed(Bus& bus, std::chrono::steady_clock::time_point now);
  /// Learns from data acquisition's heartbeat how far it has come.
  void take(const ServiceStatus& status);
  /// Sends again what data acquisition misses.
  void take(const ResendRequest& request, Bus& bus);

  /// Nothing left to send and all of it journaled by data acquisition.
  [[nodiscard]] bool done() const { return exhausted_ && unsent_.empty() && waiting_.empty(); }
  [[nodiscard]] std::uint64_t last_sequence() const { return last_sequence_; }
  [[nodiscard]] const std::string& writer_id() const { return writer_id_; }
  /// Why the bus did not take the last block that it was given; "" when it did.
  [[nodiscard]] const std::string& not_taken() const { return not_taken_; }
  /// Why data acquisition refused tests of this replay, by its heartbeats; each reason once.
  [[nodiscard]] std::vector<std::string> take_refusals() { return std::exchange(refusals_, {}); }

 private:
  void note_refusal(const ServiceStatus& status);
  [[nodiscard]] std::size_t tests_waiting() const;
  void repeat_unanswered(Bus& bus, std::chrono::steady_clock::time_point now);
  [[nodiscard]] bool publish(Bus& bus, const RawSamples& block);
  /// Whether the first unsent block is due: its last sample has been "recorded" by now.
  [[nodiscard]] bool due(std::chrono::steady_clock::time_point now) const;

  std::string writer_id_;
  std::function<std::vector<RawSamples>()> next_test_;
  std::size_t tests_ahead_;
  double speed_;
  std::deque<RawSamples> unsent_;  ///< of the test being sent
  std::chrono::steady_clock::time_point test_started_;
  std::deque<RawSamples> waiting_;  ///< sent, not yet known to be journaled; first has the lowest sequence
  std::uint64_t last_sequence_ = 0;
  std::pair<std::uint64_t, std::uint64_t> progress_;  ///< first block that waits and last one sent, at the last change
  std::chrono::steady_clock::time_point progressed_;
  bool exhausted_ = false;
  std::string not_taken_;
  std::string error_before_;  ///< the service's last error when the first block was sent
  std::vector<std::string> refusals_;
  std::set<std::string> refused_;  ///< those already told
};

/// Whether every service has taken in all that its upstream services wrote, judged by their last heartbeats.
class Quiescence {
 public:
  /// `inputs_of` tells which topics a service reads.
  explicit Quiescence(std::map<std::string, std::vector<std::string>> inputs_of) : inputs_of_(std::move(inputs_of)) {}
  using Time = std::chrono::steady_clock::time_point;
  /// A layer may keep an input of long ago. What lay around before and becomes less is still being concluded from.
  static constexpr std::chrono::seconds kStill{3};
  /// Of a service that was heard so long ago nothing is awaited.
  static constexpr std::chrono::seconds kSilent{5};

  void take(const ServiceStatus& status, Time now = std::chrono::steady_clock::now());
  /// All expected services have been heard, none has more inputs waiting than the fewest since it was first heard, their
  /// number has not changed for kStill where there are any, and each has received every stream of its input topics to
  /// its end, that of `source` up to `sequence` included.
  [[nodiscard]] bool reached(const std::string& source_writer, std::uint64_t source_sequence,
                             Time now = std::chrono::steady_clock::now()) const;
  /// Whether all expected services are heard and one of them has inputs waiting.
  [[nodiscard]] bool is_concluding(Time now = std::chrono::steady_clock::now()) const;
  /// Whether no service is so far behind the one before it that a replay should wait: `tests` messages about whole
  /// tests, or a stream's window of blocks of samples.
  [[nodiscard]] bool keeps_up(std::uint64_t tests) const;
  /// How far all services' streams of these topics go.
  [[nodiscard]] std::vector<StreamPosition> written(std::span<const Topic> topics) const;
  /// Expected services that have not been heard.
  [[nodiscard]] std::vector<std::string> missing() const;
  /// What is still under way, in words.
  [[nodiscard]] std::string explain() const;

 private:
  /// Messages of a topic that the service furthest behind has still to take.
  [[nodiscard]] std::uint64_t backlog(const std::string& topic) const;
  [[nodiscard]] bool is_done(const ServiceStatus& status, Time now) const;

  struct Waiting {
    std::uint64_t fewest = 0;
    Time changed{};
    Time heard{};
  };
  std::map<std::string, std::vector<std::string>> inputs_of_;
  std::map<std::string, ServiceStatus> last_;
  std::map<std::string, Waiting> waiting_;  ///< inputs, by service
};

}  // namespace sealwatch::cli

// Who speaks under a name that nobody here has. A service says its name (its writer id) in its heartbeat once a second;
// what comes on a topic that only services write, under another name or none, is forged, misrouted or of a service of
// which this one hears no heartbeat. Which service's real name a forger uses nobody can see without DDS Security.
//
//   a name that no heartbeat has said    unknown after `patience`: a message may overtake its writer's heartbeat
//   no name, or a service not known      unknown at once
//   a source that is no configured one   of raw samples, where senders are configured: unknown at once
//
// What a name that was not heard yet writes is left aside where unknown writers are refused: nothing is lost by it, as
// a service numbers what it writes, its heartbeat says how far, and its readers ask for what they miss. Of raw samples
// only what comes from configured senders is taken, where there are any.
//
// Pure: whoever owns it says the time. Strangers may invent as many names as they like: only so many are remembered.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "sealwatch/message/topics.hpp"
#include "sealwatch/port/bus.hpp"

namespace sealwatch {

class StrangerWatch {
 public:
  using Steady = std::chrono::nanoseconds;
  struct Options {
    std::vector<std::string> services = {};  ///< all that there are; none: nobody is judged
    std::vector<std::string> senders = {};   ///< sources of raw samples that are expected; none: all are
    std::chrono::milliseconds patience{10'000};
    bool refuses_unknown = false;  ///< else what they write is taken, and told
  };
  struct Stranger {
    std::string name;  ///< writer id, "service NAME" or "sender SOURCE"; "no name"
    std::string text;
  };

  /// Who gives a name that nobody could keep, say or log, however long it is: nothing of it is read.
  [[nodiscard]] static std::optional<Stranger> unsayable(const BusItem& item);

  explicit StrangerWatch(Options options) : options_(std::move(options)) {}

  /// Takes note of a heartbeat. Returns the stranger who said it, if any; a name said in time is that of no stranger.
  [[nodiscard]] std::vector<Stranger> hear(const ServiceStatus& status, Steady now);
  /// Takes note of a message as it came from the bus.
  [[nodiscard]] std::vector<Stranger> hear(const Message& message, Steady now);
  /// Whether the message, as it came from the bus, is to be taken in.
  [[nodiscard]] bool admits(const Message& message) const;
  /// There is room for the name of that writer, of whom the journal tells, however many names others invent.
  void expect(const std::string& writer_id) { expected_.insert(writer_id); }
  /// Those whose patience is over.
  [[nodiscard]] std::vector<Stranger> look(Steady now);
  /// Whether a heartbeat has said this name.
  [[nodiscard]] bool knows(const std::string& writer_id) const { return known_.contains(writer_id); }

 private:
  struct Waiting {
    Steady since{};
    std::string asset_id;
    std::string topic;
  };
  [[nodiscard]] bool expects(const RawSamples& raw) const;
  [[nodiscard]] bool remember(const std::string& writer_id, Steady now);

  Options options_;
  std::set<std::string> expected_;          ///< writer ids of the past
  std::map<std::string, Steady> known_;     ///< writer ids of services, and when they were last said
  std::map<std::string, Waiting> waiting_;  ///< names not said yet
};

}  // namespace sealwatch

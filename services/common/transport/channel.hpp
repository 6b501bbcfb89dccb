// One topic's DDS entities in one participant.
//
// Taking. A full DDS reader stops the one thread that delivers to all readers of the process and, once that thread's
// queue is full, the one that receives, acknowledgements to the process's own writers included: its writers then wait
// for a reader that nobody can empty. So a service's reader is never full: what arrives is taken at once, by the thread
// that delivers it, into an Inbox with a bound of its own.
//
// Order. A reader of a keyed topic gives its samples asset by asset, not as they were sent. So everything that is there
// is taken at once and put in order of the writers' time stamps, which Channel::write makes strictly increasing. For
// "everything" to have an end, samples must not come in meanwhile: the listener, which Cyclone calls after it stored a
// sample and before it stores the next, has to pass the channel's mutex, which is held while samples are taken. The
// inbox's is held no longer than it takes to put them in: who reads from it does not wait while they are decoded.
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <string_view>
#include <vector>

#include "dds/dds.h"
#include "sealwatch/port/bus.hpp"
#include "services/common/transport/dds_bus.hpp"
#include "services/common/transport/inbox.hpp"
#include "services/common/transport/topic_types.hpp"

struct ddsi_serdata;

namespace sealwatch::transport {

/// Whether DDS Security says who may write what.
enum class Rights { none, enforced };

/// What travels as a maintenance_event and has a topic of its own: retractions, and what second people say of them.
[[nodiscard]] bool is_retraction(const Message& message);

class Channel {
 public:
  static constexpr std::string_view kServiceStatus = "service_status";

  /// `type` must outlive the channel; the participant owns and deletes the entities.
  Channel(dds_entity_t participant, const TopicType& type, TopicQos qos, SlowReader slow_reader, Rights rights)
      : participant_(participant),
        type_(&type),
        qos_(qos),
        slow_reader_(slow_reader),
        rights_(rights),
        takes_at_once_(slow_reader == SlowReader::asks_again && (qos.keep_all || type.name == kServiceStatus)) {}

  [[nodiscard]] bool subscribed() const { return reader_ > 0; }
  /// Else DDS keeps the last of each asset until receive is called. Of heartbeats DDS would keep the last that anybody
  /// wrote in a service's name: a stranger's words would hide its own.
  [[nodiscard]] bool takes_at_once() const { return takes_at_once_; }
  /// Makes the reader; channel and inbox must outlive the participant.
  [[nodiscard]] Status subscribe(Inbox& inbox);
  /// A sample was stored: called by DDS's threads.
  void arrived(dds_entity_t reader);
  /// Moves what waits in DDS to the inbox, in the order of publishing. No mutex may be held.
  void take();
  /// Whether the inbox was full when last looked at: what waits in DDS then is taken when there is room again.
  [[nodiscard]] bool left_behind() const { return left_behind_; }

  /// Makes the writer, which readers find from now on.
  [[nodiscard]] Status open_writer();
  /// Waits at most 10 ms.
  [[nodiscard]] Status write(const DdsSample& sample);
  /// Readers anywhere that this participant's writer is matched with.
  [[nodiscard]] Result<std::size_t> subscribers();

 private:
  [[nodiscard]] Status open_topic();
  struct Stamped {
    dds_time_t published;
    Inbox::Writer writer;
    std::unique_ptr<BusItem> item;
  };
  /// `taking_` must be held.
  void take_all();
  /// Whether nothing more should be taken now.
  [[nodiscard]] bool inbox_is_full(std::chrono::steady_clock::time_point now) const;
  /// Takes one batch; whether there may be more.
  bool take_batch(std::vector<Stamped>& taken) const;
  [[nodiscard]] std::unique_ptr<BusItem> decode(const ddsi_serdata& sample) const;
  /// Whether who may write this topic may say that.
  [[nodiscard]] bool may_say(const BusItem& item) const;

  dds_entity_t participant_;
  const TopicType* type_;
  TopicQos qos_;
  SlowReader slow_reader_;
  Rights rights_;
  bool takes_at_once_;
  dds_entity_t topic_ = 0;
  dds_entity_t reader_ = 0;
  dds_entity_t writer_ = 0;
  dds_time_t last_written_ = 0;
  Inbox* inbox_ = nullptr;
  std::mutex taking_;  ///< held while samples are taken: by DDS's thread or by who receives
  std::atomic<bool> left_behind_ = false;
};

}  // namespace sealwatch::transport

// One topic's DDS entities in one participant.
//
// Order. A reader of a keyed topic gives its samples asset by asset, not as they were sent. So everything that is there
// is taken at once and put in order of the writers' time stamps, which Channel::write makes strictly increasing. For
// "everything" to have an end, samples must not come in meanwhile: the listener, which Cyclone calls after it stored a
// sample and before it stores the next, has to pass a gate that is shut while samples are taken.
#pragma once

#include <deque>
#include <memory>
#include <mutex>

#include "dds/dds.h"
#include "sealwatch/port/bus.hpp"
#include "services/common/transport/dds_bus.hpp"
#include "services/common/transport/sample_buffer.hpp"
#include "services/common/transport/signal.hpp"
#include "services/common/transport/topic_types.hpp"

namespace sealwatch::transport {

/// Where listeners announce samples.
struct Arrivals {
  Signal signal;
  std::mutex gate;
};

class Channel {
 public:
  /// `type` must outlive the channel; the participant owns and deletes the entities.
  Channel(dds_entity_t participant, const TopicType& type, TopicQos qos, SlowReader slow_reader)
      : participant_(participant), type_(&type), qos_(qos), slow_reader_(slow_reader) {}

  [[nodiscard]] bool subscribed() const { return reader_ > 0; }
  /// Makes the reader, which announces each sample; `arrivals` must outlive the participant.
  [[nodiscard]] Status subscribe(Arrivals& arrivals);
  /// Moves all that has arrived to the end of `items`, in the order of publishing. The gate must be shut.
  void take(std::deque<BusItem>& items) const;

  [[nodiscard]] Status write(const DdsSample& sample);
  /// Readers anywhere that this participant's writer is matched with.
  [[nodiscard]] Result<std::size_t> subscribers();

 private:
  [[nodiscard]] Status open_topic();
  [[nodiscard]] Status open_writer();
  struct Stamped {
    dds_time_t published;
    BusItem item;
  };
  /// Takes one batch; whether there was one.
  bool take_batch(std::vector<Stamped>& taken) const;

  dds_entity_t participant_;
  const TopicType* type_;
  TopicQos qos_;
  SlowReader slow_reader_;
  dds_entity_t topic_ = 0;
  dds_entity_t reader_ = 0;
  dds_entity_t writer_ = 0;
  dds_time_t last_written_ = 0;
  std::unique_ptr<SampleBuffer> buffer_;  ///< one batch
};

}  // namespace sealwatch::transport

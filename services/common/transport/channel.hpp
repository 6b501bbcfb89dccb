// One topic's DDS entities in one participant.
#pragma once

#include <deque>
#include <optional>

#include "dds/dds.h"
#include "sealwatch/port/bus.hpp"
#include "services/common/transport/dds_bus.hpp"
#include "services/common/transport/signal.hpp"
#include "services/common/transport/topic_types.hpp"

namespace sealwatch::transport {

class Channel {
 public:
  /// `type` must outlive the channel; the participant owns and deletes the entities.
  Channel(dds_entity_t participant, const TopicType& type, TopicQos qos, SlowReader slow_reader)
      : participant_(participant), type_(&type), qos_(qos), slow_reader_(slow_reader) {}

  [[nodiscard]] bool subscribed() const { return reader_ > 0; }
  /// Makes the reader, which notifies `arrival` for each sample.
  [[nodiscard]] Status subscribe(Signal& arrival);
  /// Moves at most one batch of what has arrived to the end of `items`.
  void take(std::deque<BusItem>& items) const;

  [[nodiscard]] Status write(const DdsSample& sample);
  /// Readers anywhere that this participant's writer is matched with.
  [[nodiscard]] Result<std::size_t> subscribers();

 private:
  [[nodiscard]] Status open_topic();
  [[nodiscard]] Status open_writer();

  dds_entity_t participant_;
  const TopicType* type_;
  TopicQos qos_;
  SlowReader slow_reader_;
  dds_entity_t topic_ = 0;
  dds_entity_t reader_ = 0;
  dds_entity_t writer_ = 0;
};

}  // namespace sealwatch::transport

#include "sealwatch/client/subscriber.hpp"

#include <algorithm>
#include <span>

#include "sealwatch/port/patient_publish.hpp"
#include "services/common/transport/dds_bus.hpp"

namespace sealwatch::client {
namespace {

using Clock = std::chrono::steady_clock;

/// Long enough to be found by services on the same network, short enough for a person to wait.
constexpr std::chrono::milliseconds kDiscovery{3000};

std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace

Subscriber::Subscriber(Options options) : options_(std::move(options)) {}
Subscriber::~Subscriber() = default;

Status Subscriber::connect() {
  if (!bus_) {
    Configuration configuration;
    configuration.domain = options_.domain;
    configuration.cyclonedds_uri = options_.cyclonedds_uri;
    Result<std::unique_ptr<DdsBus>> bus = open_dds_bus(configuration, SlowReader::loses_oldest);
    if (!bus) return fail(bus.error());
    bus_ = std::move(*bus);
    waiting_ = bus_.get();
  }
  return {};
}

Status Subscriber::run_for(std::chrono::milliseconds duration) {
  if (Status connected = connect(); !connected) return connected;
  for (const auto& [topic, handlers] : handlers_)
    if (Status made = bus_->subscribe(std::span(&topic, 1)); !made) return made;
  const auto end = Clock::now() + duration;
  while (!stopped_) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - Clock::now());
    if (left.count() <= 0) break;
    for (const BusItem& item : bus_->receive(left)) {
      deliver(std::get<Message>(item));
      if (stopped_) break;
    }
  }
  stopped_ = false;
  return {};
}

void Subscriber::deliver(const Message& message) {
  const Header& header = header_of(message);
  if (header.stream_sequence != 0) {  // 0: from outside, not numbered
    std::uint64_t& last = delivered_[{topic_of(message), header.writer_id, asset_of(message)}];
    if (header.stream_sequence <= last) return;
    last = header.stream_sequence;
  }
  for (const auto& handler : handlers_[topic_of(message)]) handler(message);
}

void Subscriber::stop() {
  stopped_ = true;
  if (DdsBus* const bus = waiting_; bus != nullptr) bus->wake();
}

Status Subscriber::acknowledge(const Advisory& advisory, const std::string& who, const std::string& remark) {
  if (Status connected = connect(); !connected) return connected;
  if (Status heard = bus_->wait_for_subscribers(Topic::acknowledgement, 1, kDiscovery); !heard) return heard;
  Acknowledgement acknowledgement;
  acknowledgement.asset_id = advisory.asset_id;
  acknowledgement.advisory_id = advisory.advisory_id;
  acknowledgement.acknowledged_by = who;
  acknowledgement.remark = remark;
  Header& header = acknowledgement.header;
  header.message_id = "acknowledgement/" + advisory.advisory_id + "/" + std::to_string(advisory.revision);
  header.pst_id = advisory.header.pst_id;
  header.source_ids = {advisory.header.message_id};
  header.producer = options_.name;
  header.event_time_known = true;
  header.event_time_ns = header.publishing_time_ns = now_ns();
  stamp_clock(header, read_clock());
  return publish_patiently(*bus_, Message(acknowledgement));
}

}  // namespace sealwatch::client

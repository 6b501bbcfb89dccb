#include "services/common/transport/dds_bus.hpp"

#include <algorithm>
#include <deque>
#include <iterator>
#include <mutex>
#include <thread>
#include <utility>

#include "services/common/transport/channel.hpp"
#include "services/common/transport/participant.hpp"

namespace sealwatch {
namespace {

using transport::Channel;
using transport::DdsSample;
using Clock = std::chrono::steady_clock;

class CycloneBus final : public DdsBus {
 public:
  CycloneBus(transport::Participant participant, const Configuration& configuration, SlowReader slow_reader)
      : participant_(std::move(participant)) {
    for (const transport::TopicType& type : transport::topic_types()) {
      const auto overridden = configuration.topics.find(type.name);
      const TopicQos qos = overridden == configuration.topics.end() ? type.qos : overridden->second;
      channels_.emplace_back(participant_.handle(), type, qos, slow_reader);
    }
  }

  [[nodiscard]] bool ok() const { return arrivals_.signal.ok(); }

  Status subscribe(std::span<const Topic> topics) override {
    for (const Topic topic : topics)
      if (Status made = channels_[static_cast<std::size_t>(topic)].subscribe(arrivals_); !made) return made;
    return {};
  }
  Status subscribe_service_topics() override {
    for (const std::size_t index : {transport::kServiceStatusIndex, transport::kResendRequestIndex})
      if (Status made = channels_[index].subscribe(arrivals_); !made) return made;
    return {};
  }

  Status publish(const Message& message) override { return channels_[message.index()].write(DdsSample(message)); }
  Status publish(const ServiceStatus& status) override {
    return channels_[transport::kServiceStatusIndex].write(DdsSample(status));
  }
  Status publish(const ResendRequest& request) override {
    return channels_[transport::kResendRequestIndex].write(DdsSample(request));
  }

  std::vector<BusItem> receive(std::chrono::milliseconds timeout, std::size_t most) override {
    const auto deadline = Clock::now() + timeout;
    while (true) {
      const bool woken = arrivals_.signal.clear();  // before the take: what arrives after it notifies again
      if (arrived_.empty()) take();
      if (!arrived_.empty() || woken || Clock::now() >= deadline) break;
      arrivals_.signal.wait_until(deadline);
    }
    const auto end = std::next(arrived_.begin(), static_cast<std::ptrdiff_t>(std::min(most, arrived_.size())));
    std::vector<BusItem> items(std::move_iterator(arrived_.begin()), std::move_iterator(end));
    arrived_.erase(arrived_.begin(), end);
    return items;
  }

  void wake() override { arrivals_.signal.wake(); }

  Status wait_for_subscribers(Topic topic, std::size_t count, std::chrono::milliseconds timeout) override {
    const auto deadline = Clock::now() + timeout;
    while (true) {
      const Result<std::size_t> matched = channels_[static_cast<std::size_t>(topic)].subscribers();
      if (!matched) return fail(matched.error());
      if (*matched >= count) return {};
      if (Clock::now() >= deadline)
        return fail(Error{.file = {},
                          .place = "topic " + std::string(name_of(topic)),
                          .value = std::to_string(*matched) + " subscribers",
                          .rule = "must have " + std::to_string(count),
                          .advice = "are the services up, in the same domain?"});
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }

 private:
  void take() {
    const std::lock_guard gate(arrivals_.gate);
    for (const Channel& channel : channels_)
      if (channel.subscribed()) channel.take(arrived_);
  }

  transport::Arrivals arrivals_;  // outlives the participant, whose listeners use it
  transport::Participant participant_;
  std::vector<Channel> channels_;
  std::deque<BusItem> arrived_;  ///< taken from DDS, not yet asked for
};

}  // namespace

Result<std::unique_ptr<DdsBus>> open_dds_bus(const Configuration& configuration, SlowReader slow_reader) {
  Result<transport::Participant> participant = transport::Participant::join(configuration);
  if (!participant) return fail(participant.error());
  auto bus = std::make_unique<CycloneBus>(std::move(*participant), configuration, slow_reader);
  if (!bus->ok()) return fail("the process has no file descriptor left for a bus");
  return bus;
}

Status check_dds_settings(const std::string& cyclonedds_uri) {
  if (cyclonedds_uri.empty()) return {};
  constexpr dds_domainid_t kUnused = 231;  // made and deleted: nobody is met there
  const dds_entity_t domain = dds_create_domain(kUnused, cyclonedds_uri.c_str());
  if (domain < 0)
    return transport::dds_failure("key cyclonedds_uri", domain,
                                  "an unknown XML element is fatal; what is wrong stands above, by Cyclone DDS itself");
  dds_delete(domain);
  return {};
}

Result<std::unique_ptr<Bus>> make_dds_bus(const Configuration& configuration) {
  return open_dds_bus(configuration).map([](std::unique_ptr<DdsBus>&& bus) {
    return std::unique_ptr<Bus>(std::move(bus));
  });
}

}  // namespace sealwatch

#include "services/common/transport/dds_bus.hpp"

#include <algorithm>
#include <deque>
#include <mutex>
#include <set>
#include <thread>
#include <utility>

#include "services/common/transport/channel.hpp"
#include "services/common/transport/inbox.hpp"
#include "services/common/transport/participant.hpp"

namespace sealwatch {
namespace {

using transport::Channel;
using transport::DdsSample;
using Clock = std::chrono::steady_clock;

transport::Rights rights_of(const Configuration& configuration) {
  return transport::is_secured(configuration) ? transport::Rights::enforced : transport::Rights::none;
}

class CycloneBus final : public DdsBus {
 public:
  CycloneBus(transport::Participant participant, const Configuration& configuration, SlowReader slow_reader)
      : participant_(std::move(participant)) {
    for (const transport::TopicType& type : transport::topic_types()) {
      const auto overridden = configuration.topics.find(type.name);
      const TopicQos qos = overridden == configuration.topics.end() ? type.qos : overridden->second;
      channels_.emplace_back(participant_.handle(), type, qos, slow_reader, rights_of(configuration));
    }
    std::set<std::string> assets;
    for (const AssetConfig& asset : configuration.assets) assets.insert(asset.asset_id);
    inbox_.know(std::move(assets), {configuration.senders.begin(), configuration.senders.end()});
  }

  [[nodiscard]] bool ok() const { return inbox_.signal.ok(); }

  Status subscribe(std::span<const Topic> topics) override {
    for (const Topic topic : topics) {
      if (Status made = channels_[static_cast<std::size_t>(topic)].subscribe(inbox_); !made) return made;
      if (topic == Topic::maintenance_event)
        if (Status made = channels_[transport::kRetractionIndex].subscribe(inbox_); !made) return made;
    }
    return {};
  }
  Status subscribe_service_topics() override {
    for (const std::size_t index : {transport::kServiceStatusIndex, transport::kResendRequestIndex})
      if (Status made = channels_[index].subscribe(inbox_); !made) return made;
    return {};
  }
  Status announce(std::span<const Topic> topics) override {
    for (const Topic topic : topics)
      if (Status opened = channels_[static_cast<std::size_t>(topic)].open_writer(); !opened) return opened;
    return channels_[transport::kResendRequestIndex].open_writer();
  }

  Status publish(const Message& message) override {
    const std::size_t index = transport::is_retraction(message) ? transport::kRetractionIndex : message.index();
    return channels_[index].write(DdsSample(message));
  }
  Status publish(const ServiceStatus& status) override {
    return channels_[transport::kServiceStatusIndex].write(DdsSample(status));
  }
  Status publish(const ResendRequest& request) override {
    return channels_[transport::kResendRequestIndex].write(DdsSample(request));
  }

  std::vector<BusItem> receive(std::chrono::milliseconds timeout, std::size_t most) override {
    const auto deadline = Clock::now() + timeout;
    while (true) {
      const bool woken = inbox_.signal.clear();  // before the take: what arrives after it notifies again
      std::vector<BusItem> items = take(most);
      if (!items.empty() || woken || Clock::now() >= deadline) return items;
      inbox_.signal.wait_until(std::min(deadline, Clock::now() + longest_wait()));
    }
  }

  bool has_more() override { return has_more_; }

  std::vector<Flood> floods() override {
    const std::lock_guard lock(inbox_.mutex);
    return inbox_.floods();
  }

  void wake() override { inbox_.signal.wake(); }

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
  std::vector<BusItem> take(std::size_t most) {
    // What DDS keeps for a client it goes on thinning out until all is asked for.
    const bool all = is_empty();
    for (Channel& channel : channels_)
      if (channel.subscribed() && (channel.takes_at_once() ? channel.left_behind() : all)) channel.take();
    const std::lock_guard lock(inbox_.mutex);
    std::vector<BusItem> taken = inbox_.take(most, Clock::now());
    has_more_ = inbox_.has_more();
    return taken;
  }

  [[nodiscard]] bool is_empty() {
    const std::lock_guard lock(inbox_.mutex);
    return inbox_.empty();
  }

  [[nodiscard]] Clock::duration longest_wait() {
    constexpr std::chrono::milliseconds kOfStrangers{20};
    const std::lock_guard lock(inbox_.mutex);
    return inbox_.strangers_wait() ? Clock::duration(kOfStrangers) : Clock::duration(std::chrono::hours(1));
  }

  transport::Inbox inbox_;        // both outlive the participant,
  std::deque<Channel> channels_;  // whose listeners use them, by their addresses
  transport::Participant participant_;
  bool has_more_ = false;  ///< after the last take
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

// The bus inside one process: for tests, and wherever layers' runners share a process. Same contract as over DDS.
#pragma once

#include <condition_variable>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <utility>

#include "sealwatch/port/bus.hpp"

namespace sealwatch {

/// What InMemoryBus participants are connected to. A participant also receives what it publishes itself.
class InMemoryNetwork {
 public:
  /// One participant's end: what it asked for and what waits for it.
  struct Participant {
    std::set<Topic> topics;
    bool service_topics = false;
    bool woken = false;
    std::deque<BusItem> waiting;
    std::map<std::pair<Topic, std::string>, std::pair<std::uint64_t, Message>> last_published;  ///< by topic and asset
    std::condition_variable arrived;
  };

  void join(Participant* participant) {
    const std::lock_guard lock(mutex_);
    participants_.insert(participant);
  }

  /// A participant that ends takes its history with it, as a DDS writer does.
  void leave(Participant* participant) {
    const std::lock_guard lock(mutex_);
    participants_.erase(participant);
  }

  void subscribe(Participant* participant, std::span<const Topic> topics) {
    const std::lock_guard lock(mutex_);
    std::set<Topic> added;
    for (const Topic topic : topics)
      if (participant->topics.insert(topic).second) added.insert(topic);
    std::map<std::uint64_t, const Message*> history;  // in the order of publishing
    for (const Participant* publisher : participants_)
      for (const auto& [key, last] : publisher->last_published)
        if (added.contains(key.first)) history.emplace(last.first, &last.second);
    for (const auto& [order, message] : history) put(participant, to_item(*message));
  }

  void subscribe_service_topics(Participant* participant) {
    const std::lock_guard lock(mutex_);
    participant->service_topics = true;
  }

  void publish(Participant* publisher, const Message& message) {
    const std::lock_guard lock(mutex_);
    const Topic topic = topic_of(message);
    publisher->last_published.insert_or_assign({topic, asset_of(message)}, std::pair{++published_, message});
    for (Participant* participant : participants_)
      if (participant->topics.contains(topic)) put(participant, to_item(message));
  }

  void publish_service(const BusItem& item) {
    const std::lock_guard lock(mutex_);
    for (Participant* participant : participants_)
      if (participant->service_topics) put(participant, item);
  }

  [[nodiscard]] std::vector<BusItem> receive(Participant* participant, std::chrono::milliseconds timeout,
                                             std::size_t most) {
    std::unique_lock lock(mutex_);
    participant->arrived.wait_for(lock, timeout,
                                  [participant] { return participant->woken || !participant->waiting.empty(); });
    participant->woken = false;
    std::vector<BusItem> taken;
    for (; taken.size() < most && !participant->waiting.empty(); participant->waiting.pop_front())
      taken.push_back(std::move(participant->waiting.front()));
    return taken;
  }

  void wake(Participant* participant) {
    const std::lock_guard lock(mutex_);
    participant->woken = true;
    participant->arrived.notify_all();
  }

 private:
  static BusItem to_item(const Message& message) { return BusItem(std::in_place_type<Message>, message); }

  static void put(Participant* participant, const BusItem& item) {
    participant->waiting.push_back(item);
    participant->arrived.notify_all();
  }

  std::mutex mutex_;
  std::set<Participant*> participants_;
  std::uint64_t published_ = 0;
};

class InMemoryBus final : public Bus {
 public:
  explicit InMemoryBus(std::shared_ptr<InMemoryNetwork> network) : network_(std::move(network)) {
    network_->join(&participant_);
  }
  ~InMemoryBus() override { network_->leave(&participant_); }
  InMemoryBus(const InMemoryBus&) = delete;
  InMemoryBus& operator=(const InMemoryBus&) = delete;

  [[nodiscard]] Status subscribe(std::span<const Topic> topics) override {
    network_->subscribe(&participant_, topics);
    return {};
  }
  [[nodiscard]] Status subscribe_service_topics() override {
    network_->subscribe_service_topics(&participant_);
    return {};
  }
  [[nodiscard]] Status publish(const Message& message) override {
    network_->publish(&participant_, message);
    return {};
  }
  [[nodiscard]] Status publish(const ServiceStatus& status) override {
    network_->publish_service(status);
    return {};
  }
  [[nodiscard]] Status publish(const ResendRequest& request) override {
    network_->publish_service(request);
    return {};
  }
  [[nodiscard]] std::vector<BusItem> receive(std::chrono::milliseconds timeout, std::size_t most = 64) override {
    return network_->receive(&participant_, timeout, most);
  }
  void wake() override { network_->wake(&participant_); }

 private:
  std::shared_ptr<InMemoryNetwork> network_;
  InMemoryNetwork::Participant participant_;
};

}  // namespace sealwatch

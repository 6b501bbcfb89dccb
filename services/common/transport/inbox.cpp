#include "services/common/transport/inbox.hpp"

#include <algorithm>
#include <utility>

namespace sealwatch::transport {
namespace {

/// Names that are told apart of those who flood; a stranger may invent as many as it likes.
constexpr std::size_t kMostNames = 16;

std::size_t index_of(const BusItem& item) {
  if (const auto* message = std::get_if<Message>(&item)) return message->index();
  return std::holds_alternative<ServiceStatus>(item) ? kServiceStatusIndex : kResendRequestIndex;
}

bool comes_again(const BusItem& item) {
  const auto* message = std::get_if<Message>(&item);
  if (message == nullptr) return true;
  const Header& header = header_of(*message);
  return !header.writer_id.empty() && header.stream_sequence != 0;
}

/// In the place of that writer's earlier word about the same service.
bool replaces(std::deque<BusItem>& queue, BusItem& item) {
  const auto* status = std::get_if<ServiceStatus>(&item);
  if (status == nullptr) return false;
  for (BusItem& earlier : queue)
    if (std::get<ServiceStatus>(earlier).service == status->service) return earlier = std::move(item), true;
  return false;
}

}  // namespace

void Inbox::know(std::set<std::string> assets, std::set<std::string> senders) {
  assets_ = std::move(assets);
  senders_ = std::move(senders);
}

bool Inbox::is_strangers(const BusItem& item) const {
  if (assets_.empty() || comes_again(item)) return false;
  const Message& message = std::get<Message>(item);
  const auto* raw = std::get_if<RawSamples>(&message);
  return !assets_.contains(asset_of(message)) && !(raw != nullptr && senders_.contains(raw->source_id));
}

bool Inbox::is_left_out(const std::deque<BusItem>& queue, std::size_t topic, std::size_t limit) const {
  if (topic == kServiceStatusIndex) return queue.size() >= kMostStatuses;
  return waiting_[topic] >= limit && queue.size() >= limit / std::max<std::size_t>(writers_[topic], 1);
}

void Inbox::drop(const BusItem& item) {
  const Message& message = std::get<Message>(item);
  const auto* raw = std::get_if<RawSamples>(&message);
  const std::string name = raw != nullptr ? raw->source_id : std::string(name_of(topic_of(message)));
  ++dropped_[dropped_.contains(name) || dropped_.size() < kMostNames ? name : "others"];
}

void Inbox::put(Writer writer, BusItem item, std::size_t limit) {
  const std::size_t topic = index_of(item);
  const Key key{is_strangers(item), writer};
  if (key.first && strangers_waiting_ >= kMostOfStrangers) return drop(item);
  const auto [place, is_new] = queues_.try_emplace(key);
  std::deque<BusItem>& queue = place->second;
  if (is_new && !key.first) ++writers_[topic];
  if (replaces(queue, item)) return;
  if (!key.first && comes_again(item) && is_left_out(queue, topic, limit)) {
    if (!is_new) return;
    --writers_[topic];
    queues_.erase(place);
    return;
  }
  ++(key.first ? strangers_waiting_ : waiting_[topic]);
  queue.push_back(std::move(item));
  if (is_new) turns_.push_back(key);
}

BusItem Inbox::take_one(const Key& key) {
  const auto place = queues_.find(key);
  BusItem item = std::move(place->second.front());
  place->second.pop_front();
  const std::size_t topic = index_of(item);
  --(key.first ? strangers_waiting_ : waiting_[topic]);
  if (place->second.empty()) {
    if (!key.first) --writers_[topic];
    queues_.erase(place);
  } else {
    turns_.push_back(key);
  }
  return item;
}

std::vector<BusItem> Inbox::take(std::size_t most, Time now) {
  constexpr auto kRate = static_cast<double>(kStrangersASecond);
  strangers_may_ += std::chrono::duration<double>(now - strangers_looked_).count() * kRate;
  strangers_may_ = std::min(strangers_may_, kRate);
  strangers_looked_ = now;
  std::vector<BusItem> taken;
  std::deque<Key> later;  // strangers' queues of which nothing may be taken now
  while (taken.size() < most && !turns_.empty()) {
    const Key key = turns_.front();
    turns_.pop_front();
    if (key.first && strangers_may_ < 1.0) {
      later.push_back(key);
      continue;
    }
    if (key.first) strangers_may_ -= 1.0;
    taken.push_back(take_one(key));
  }
  turns_.insert(turns_.end(), later.begin(), later.end());
  return taken;
}

std::vector<Flood> Inbox::floods() {
  std::vector<Flood> told;
  for (const auto& [name, count] : std::exchange(dropped_, {})) told.push_back({name, count});
  return told;
}

}  // namespace sealwatch::transport

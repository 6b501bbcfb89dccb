#include "services/common/transport/inbox.hpp"

#include <algorithm>
#include <utility>

namespace sealwatch::transport {
namespace {

/// Names that are told apart of those who flood; a stranger may invent as many as it likes.
constexpr std::size_t kMostNames = 16;
/// Writers and assets that are remembered of a topic: one writer more than one counts as many, and of more assets each
/// has one message of a take all the same.
constexpr std::size_t kMostHeard = 64;
/// Of one asset in a take: a sender of many assets sends several blocks of one after the other, and all the others'
/// behind them wait for the next take.
constexpr std::size_t kSmallestShare = 8;

void note(std::map<std::string, Inbox::Time>& heard, const std::string& name, Inbox::Time now) {
  if (heard.size() < kMostHeard || heard.contains(name)) heard[name] = now;
}

// A sender that starts again is the same one, though DDS sees another writer.
std::string name_of(const BusItem& item, Inbox::Writer writer) {
  const auto* message = std::get_if<Message>(&item);
  const auto* raw = message == nullptr ? nullptr : std::get_if<RawSamples>(message);
  return raw != nullptr && !raw->source_id.empty() ? raw->source_id : "writer " + std::to_string(writer);
}

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
bool replaces(std::deque<std::unique_ptr<BusItem>>* line, std::unique_ptr<BusItem>& item) {
  const auto* status = std::get_if<ServiceStatus>(item.get());
  if (status == nullptr || line == nullptr) return false;
  for (std::unique_ptr<BusItem>& earlier : *line)
    if (std::get<ServiceStatus>(*earlier).service == status->service) return earlier = std::move(item), true;
  return false;
}

}  // namespace

std::size_t Inbox::Queue::size_of(const std::string& line) const {
  const auto found = lines_.find(line);
  return found == lines_.end() ? 0 : found->second.size();
}

Inbox::Line* Inbox::Queue::find(const std::string& line) {
  const auto found = lines_.find(line);
  return found == lines_.end() ? nullptr : &found->second;
}

void Inbox::Queue::add(const std::string& line, std::unique_ptr<BusItem> item) {
  const auto [place, is_new] = lines_.try_emplace(line);
  place->second.push_back(std::move(item));
  ++size_;
  if (is_new) turns_.push_back(line);
}

bool Inbox::Queue::turn_to(const std::function<bool(const BusItem&)>& may_be_taken) {
  for (std::size_t k = 0; k < turns_.size(); ++k) {
    if (may_be_taken(*lines_.at(turns_.front()).front())) return true;
    turns_.push_back(std::move(turns_.front()));
    turns_.pop_front();
  }
  return false;
}

std::unique_ptr<BusItem> Inbox::Queue::take() {
  const auto place = lines_.find(turns_.front());
  turns_.pop_front();
  std::unique_ptr<BusItem> item = std::move(place->second.front());
  place->second.pop_front();
  --size_;
  if (place->second.empty())
    lines_.erase(place);
  else
    turns_.push_back(place->first);
  return item;
}

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

bool Inbox::is_beyond_share(const Queue& queue, const std::string& line, std::size_t topic, std::size_t limit) const {
  const std::size_t added = queue.size_of(line) == 0 ? 1 : 0, lines = queue.lines() + added;
  // A gateway of many assets may have as much of each as a sender of one. Where assets can be invented, senders count.
  const std::size_t share = assets_.empty() ? limit / writers_[topic] : limit * lines / (lines_[topic] + added);
  return waiting_[topic] >= limit && queue.size() >= share && queue.size_of(line) >= share / lines;
}

bool Inbox::is_left_out(const Queue& queue, std::size_t topic, std::size_t limit) const {
  if (topic == kServiceStatusIndex) return queue.size() >= kMostStatuses;
  return waiting_[topic] >= limit && queue.size() >= limit / writers_[topic];
}

// Assets that are not configured share one line: a sender may invent as many as it likes.
std::string Inbox::line_of(const BusItem& item) const {
  const auto* message = std::get_if<Message>(&item);
  const auto* raw = message == nullptr ? nullptr : std::get_if<RawSamples>(message);
  const bool has_own = raw != nullptr && !comes_again(item) && (assets_.empty() || assets_.contains(raw->asset_id));
  return has_own ? raw->asset_id : std::string();
}

bool Inbox::is_alone(std::size_t topic, Time now) {
  std::erase_if(heard_[topic], [now](const auto& writer) { return now - writer.second > kForgotten; });
  return heard_[topic].size() <= 1;
}

bool Inbox::is_full(std::size_t topic, std::size_t limit, Time now) {
  return waiting_[topic] >= 2 * limit && is_alone(topic, now);
}

void Inbox::drop(const BusItem& item) {
  const Message& message = std::get<Message>(item);
  const auto* raw = std::get_if<RawSamples>(&message);
  const std::string name = raw != nullptr ? raw->source_id : std::string(name_of(topic_of(message)));
  ++dropped_[dropped_.contains(name) || dropped_.size() < kMostNames ? name : "others"];
}

void Inbox::note_heard(Writer writer, const BusItem& item, std::size_t topic, Time now) {
  note(heard_[topic], name_of(item, writer), now);
  if (!comes_again(item)) note(heard_assets_[topic], asset_of(std::get<Message>(item)), now);
}

void Inbox::put(Writer writer, std::unique_ptr<BusItem> item, std::size_t limit, Time now) {
  const std::size_t topic = index_of(*item);
  const Key key{is_strangers(*item), writer};
  if (key.first && strangers_waiting_ >= kMostOfStrangers) return drop(*item);
  if (!key.first) note_heard(writer, *item, topic, now);
  const auto [place, is_new] = queues_.try_emplace(key);
  Queue& queue = place->second;
  if (is_new) ++(key.first ? strangers_queues_ : writers_[topic]);
  const std::string line = key.first ? std::string() : line_of(*item);
  if (replaces(queue.find(line), item)) return;
  const bool again = comes_again(*item);
  const bool is_left = !key.first && again && is_left_out(queue, topic, limit);
  const std::size_t most = std::max(2 * limit, assets_.size());  // one block of each, however large the fleet
  const bool is_flood = !key.first && !again && is_beyond_share(queue, line, topic, most) && !is_alone(topic, now);
  if (is_left || is_flood) {
    if (is_flood) drop(*item);
    if (!is_new) return;
    --writers_[topic];  // no queue is empty
    queues_.erase(place);
    return;
  }
  ++(key.first ? strangers_waiting_ : waiting_[topic]);
  if (queue.find(line) == nullptr && !key.first) ++lines_[topic];
  queue.add(line, std::move(item));
  if (is_new) turns_.push_back(key);
}

std::unique_ptr<BusItem> Inbox::take_one(const Key& key) {
  const auto place = queues_.find(key);
  const std::size_t lines = place->second.lines();
  std::unique_ptr<BusItem> item = place->second.take();
  const std::size_t topic = index_of(*item);
  if (!key.first) lines_[topic] -= lines - place->second.lines();
  --(key.first ? strangers_waiting_ : waiting_[topic]);
  if (place->second.empty()) {
    --(key.first ? strangers_queues_ : writers_[topic]);
    queues_.erase(place);
  } else {
    turns_.push_back(key);
  }
  return item;
}

std::size_t Inbox::share_of_asset(std::size_t topic, std::size_t most, Time now) {
  std::erase_if(heard_assets_[topic], [now](const auto& asset) { return now - asset.second > kForgotten; });
  return std::max<std::size_t>(most / std::max<std::size_t>(heard_assets_[topic].size(), 1), kSmallestShare);
}

bool Inbox::is_in_share(const BusItem& item, Shares& taken, std::size_t most, Time now) {
  if (comes_again(item)) return true;
  const std::size_t topic = index_of(item);
  std::size_t& of_asset = taken[{topic, asset_of(std::get<Message>(item))}];
  if (of_asset >= share_of_asset(topic, most, now)) return false;
  ++of_asset;
  return true;
}

std::vector<BusItem> Inbox::take(std::size_t most, Time now) {
  constexpr auto kRate = static_cast<double>(kStrangersASecond);
  strangers_may_ += std::chrono::duration<double>(now - strangers_looked_).count() * kRate;
  strangers_may_ = std::min(strangers_may_, kRate);
  strangers_looked_ = now;
  std::vector<BusItem> taken;
  Shares of_assets;
  std::deque<Key> later;  // queues of which nothing may be taken now
  while (taken.size() < most && !turns_.empty()) {
    const Key key = turns_.front();
    turns_.pop_front();
    const auto in_share = [&](const BusItem& item) { return is_in_share(item, of_assets, most, now); };
    const bool may = key.first ? strangers_may_ >= 1.0 : queues_.at(key).turn_to(in_share);
    if (!may) {
      later.push_back(key);
      continue;
    }
    if (key.first) strangers_may_ -= 1.0;
    taken.push_back(std::move(*take_one(key)));
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

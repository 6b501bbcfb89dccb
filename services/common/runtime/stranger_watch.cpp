#include "services/common/runtime/stranger_watch.hpp"

#include <algorithm>

#include "services/common/runtime/admission.hpp"

namespace sealwatch {
namespace {

constexpr std::size_t kMostKnown = 1024;
constexpr std::size_t kMostWaiting = 256;
/// A service that has been silent for so long makes room for another name.
constexpr std::chrono::minutes kForgotten{10};

/// What people and their systems write; all else comes from services alone.
bool is_from_outside(Topic topic) {
  return topic == Topic::raw_samples || topic == Topic::acknowledgement || topic == Topic::maintenance_event ||
         topic == Topic::model_acceptance;
}

/// Of a name as long as a stranger likes, so much as can be said and kept.
std::string as_told(const std::string& name) { return name.substr(0, kLongestId); }

StrangerWatch::Stranger nameless(const Message& message) {
  return {"no name", std::string(name_of(topic_of(message))) + " about " + as_told(asset_of(message)) +
                         " came without a writer's name; only services write that topic"};
}

bool is_long(const std::string& name) { return name.size() > kLongestId; }

bool is_long(const StreamPosition& position) { return is_long(position.topic) || is_long(position.writer_id); }

bool has_long_name(const ServiceStatus& status) {
  return is_long(status.service) || is_long(status.writer_id) ||
         std::ranges::any_of(status.written, [](const StreamPosition& one) { return is_long(one); }) ||
         std::ranges::any_of(status.received, [](const StreamPosition& one) { return is_long(one); });
}

bool has_long_name(const ResendRequest& request) {
  return is_long(request.writer_id) || is_long(request.topic) || is_long(request.requested_by);
}

bool has_long_name(const Message& message) { return is_long(header_of(message).writer_id); }

}  // namespace

std::optional<StrangerWatch::Stranger> StrangerWatch::unsayable(const BusItem& item) {
  if (!std::visit([](const auto& content) { return has_long_name(content); }, item)) return std::nullopt;
  const auto* message = std::get_if<Message>(&item);
  const std::string what = message != nullptr                            ? std::string(name_of(topic_of(*message)))
                           : std::holds_alternative<ServiceStatus>(item) ? "service_status"
                                                                         : "resend_request";
  return Stranger{"no name", "what came on " + what + " names a writer with more than " + std::to_string(kLongestId) +
                                 " bytes; it was not read"};
}

bool StrangerWatch::remember(const std::string& writer_id, Steady now) {
  if (!known_.contains(writer_id) && known_.size() >= kMostKnown)
    std::erase_if(known_, [&](const auto& entry) { return now - entry.second > kForgotten; });
  if (!known_.contains(writer_id) && known_.size() >= kMostKnown && !expected_.contains(writer_id)) return false;
  known_[writer_id] = now;
  return true;
}

std::vector<StrangerWatch::Stranger> StrangerWatch::hear(const ServiceStatus& status, Steady now) {
  if (options_.services.empty()) return {};
  if (std::ranges::find(options_.services, status.service) == options_.services.end())
    return {{"service " + status.service, "it sends heartbeats but is not one of the services"}};
  if (remember(status.writer_id, now)) waiting_.erase(status.writer_id);
  return {};
}

bool StrangerWatch::expects(const RawSamples& raw) const {
  return options_.senders.empty() || std::ranges::find(options_.senders, raw.source_id) != options_.senders.end();
}

bool StrangerWatch::admits(const Message& message) const {
  if (const auto* raw = std::get_if<RawSamples>(&message)) return expects(*raw);
  return !options_.refuses_unknown || options_.services.empty() || is_from_outside(topic_of(message)) ||
         knows(header_of(message).writer_id);
}

std::vector<StrangerWatch::Stranger> StrangerWatch::hear(const Message& message, Steady now) {
  if (const auto* raw = std::get_if<RawSamples>(&message)) {
    if (expects(*raw)) return {};
    return {{"sender " + as_told(raw->source_id), "it sends raw samples of " + as_told(raw->asset_id) +
                                                      " and is not one of the configured senders: they are refused"}};
  }
  if (options_.services.empty() || is_from_outside(topic_of(message))) return {};
  const std::string& writer_id = header_of(message).writer_id;
  if (writer_id.empty()) return {nameless(message)};
  if (known_.contains(writer_id) || waiting_.contains(writer_id) || waiting_.size() >= kMostWaiting) return {};
  waiting_[writer_id] = {now, as_told(asset_of(message)), std::string(name_of(topic_of(message)))};
  return {};
}

std::vector<StrangerWatch::Stranger> StrangerWatch::look(Steady now) {
  std::vector<Stranger> strangers;
  for (auto entry = waiting_.begin(); entry != waiting_.end();) {
    const auto& [name, waiting] = *entry;
    if (now - waiting.since < options_.patience) {
      ++entry;
      continue;
    }
    strangers.push_back({name, "it writes " + waiting.topic + " about " + waiting.asset_id +
                                   ", and no service's heartbeat has said this name"});
    entry = waiting_.erase(entry);
  }
  return strangers;
}

}  // namespace sealwatch

#include "services/common/runtime/in_process_pipeline.hpp"

#include <algorithm>

#include "services/common/runtime/identity.hpp"

namespace sealwatch {

InProcessPipeline::InProcessPipeline(std::vector<std::unique_ptr<Layer>> layers, Observer observer)
    : observer_(std::move(observer)) {
  for (auto& layer : layers) readers_.push_back({std::move(layer), {}, {}});
}

void InProcessPipeline::push(const Message& message) {
  waiting_.push_back(without_stamps(message));
  while (!waiting_.empty()) {
    const Message next = std::move(waiting_.front());
    waiting_.pop_front();
    for (Reader& reader : readers_) {
      const auto inputs = reader.layer->inputs();
      if (std::ranges::find(inputs, topic_of(next)) != inputs.end()) deliver(reader, next);
    }
  }
}

void InProcessPipeline::deliver(Reader& reader, const Message& message) {
  const auto last = std::pair{topic_of(message), asset_of(message)};
  const auto id = identify(message, {.has = [&](const std::string& known) { return reader.received.contains(known); },
                                     .last_unnumbered =
                                         [&](Topic, const std::string&) {
                                           const auto found = reader.last_unnumbered.find(last);
                                           return found == reader.last_unnumbered.end() ? std::string() : found->second;
                                         }});
  if (!id) return;
  reader.received.insert(*id);
  reader.last_unnumbered[last] = *id;
  Message input = message;
  header_of(input).message_id = *id;
  for (Message& output : completed(reader.layer->receive(input)).outputs) {
    if (!concluded_.insert(header_of(output).message_id).second) continue;
    if (observer_) observer_(output);
    waiting_.push_back(std::move(output));
  }
}

}  // namespace sealwatch

#include "services/common/message/packed.hpp"

#include <variant>

#include "sealwatch/core/text.hpp"
#include "sealwatch/message/blank.hpp"

namespace sealwatch {
namespace {

constexpr std::size_t kTopics = std::variant_size_v<MessageAlternatives>;

const Message* last_of(Topic topic, const LastOfTopics& last) {
  const auto index = static_cast<std::size_t>(topic);
  return index < last.size() ? last[index] : nullptr;
}

template <std::size_t index = 0>
void describe_topics(std::string& text) {
  if constexpr (index < kTopics) {
    text.append(name_of(static_cast<Topic>(index))).append("=");
    describe_layout<std::variant_alternative_t<index, MessageAlternatives>>(text);
    describe_topics<index + 1>(text);
  }
}

}  // namespace

const std::string& packed_layout() {
  static const std::string name = [] {
    std::string text = "1 ";  // of the way in which values are packed
    describe_topics(text);
    return content_hash(text);
  }();
  return name;
}

void pack(const Message& message, LastOfTopics& last, std::string& bytes) {
  const Topic topic = topic_of(message);
  Packer packer(bytes);
  packer.pack(topic, Topic{});
  const Message* const before = last_of(topic, last);
  std::visit(
      [&](const auto& content) {
        using Content = std::decay_t<decltype(content)>;
        if (before != nullptr)
          packer.pack(content, std::get<Content>(*before));
        else
          packer.pack(content, Content{});
      },
      message);
  last.resize(kTopics, nullptr);
  last[static_cast<std::size_t>(topic)] = &message;
}

std::optional<Message> unpack(Unpacker& bytes, const LastOfTopics& last) {
  Topic topic{};
  if (!bytes.unpack(topic)) return std::nullopt;
  const Message* const before = last_of(topic, last);
  std::optional<Message> message = before != nullptr ? *before : blank_message(topic);
  const bool good = std::visit([&](auto& content) { return bytes.unpack(content); }, *message);
  return good ? std::move(message) : std::nullopt;
}

}  // namespace sealwatch

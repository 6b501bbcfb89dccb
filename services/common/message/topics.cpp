#include "sealwatch/message/topics.hpp"

namespace sealwatch {

Message::Message() = default;
Message::Message(const Message& other) = default;
Message::Message(Message&& other) noexcept = default;
Message& Message::operator=(const Message& other) = default;
Message& Message::operator=(Message&& other) noexcept = default;
Message::~Message() = default;

const Header& header_of(const Message& message) {
  return std::visit([](const auto& m) -> const Header& { return m.header; }, message);
}

Header& header_of(Message& message) {
  return std::visit([](auto& m) -> Header& { return m.header; }, message);
}

const std::string& asset_of(const Message& message) {
  return std::visit([](const auto& m) -> const std::string& { return m.asset_id; }, message);
}

}  // namespace sealwatch

// Any text as a message in JSON, as `sealwatch publish` and the journal read it; the first byte chooses the topic: an error
// that says what is wrong, or a message that stays what it is when it is written and read again. With a blank behind it,
// it is read by way of a document tree, to the same.
#include <cstdint>
#include <cstdlib>
#include <string>

#include "services/common/message/json.hpp"

namespace {

void require(bool holds) {
  if (!holds) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sealwatch;
  if (size == 0) return 0;
  constexpr std::size_t kTopics = EnumNames<Topic>::kNames.size();
  const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
  const std::size_t choice = data[0] % (kTopics + 1);
  if (choice == kTopics) {
    if (const auto entry = alarm_from_json(text)) require(alarm_from_json(to_json(*entry)).has_value());
    return 0;
  }
  const auto topic = static_cast<Topic>(choice);
  const Result<Message> message = message_from_json(topic, text);
  const Result<Message> by_tree = message_from_json(topic, std::string(text) + " ");
  require(message.has_value() == by_tree.has_value());
  if (message) require(to_json(*message, JsonForm::exact) == to_json(*by_tree, JsonForm::exact));
  if (!message) return require(!message.error().rule.empty()), 0;
  const std::string written = to_json(*message, JsonForm::exact);
  const Result<Message> again = message_from_json(topic, written);
  require(again.has_value() && to_json(*again, JsonForm::exact) == written);
  (void)to_json(*message);
  return 0;
}

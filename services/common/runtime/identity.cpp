#include "services/common/runtime/identity.hpp"

#include "sealwatch/core/text.hpp"
#include "services/common/message/json.hpp"

namespace sealwatch {
namespace {

/// The content of a message that gives no id, as it was written before headers had the last four fields: what came
/// before an update and comes again after it has the same id.
std::string content_of(const Message& message) {
  std::string content = to_json(without_stamps(message), JsonForm::exact);
  constexpr std::string_view kLater =
      R"(,"writer_started_ns":0,"clock_quality":"unknown","clock_error_known":false,"clock_error_s":0.0)";
  if (const std::size_t at = content.find(kLater); at != std::string::npos) content.erase(at, kLater.size());
  return content;
}

}  // namespace

bool is_numbered(const Message& message) {
  const Header& header = header_of(message);
  return !header.writer_id.empty() && header.stream_sequence != 0;
}

Message without_stamps(Message message) {
  Header& header = header_of(message);
  header.writer_id.clear();
  header.stream_sequence = 0;
  header.publishing_time_ns = 0;
  header.writer_started_ns = 0;
  stamp_clock(header, {});
  return message;
}

std::optional<std::string> identify(const Message& message, const EarlierInputs& earlier) {
  if (const std::string& own = header_of(message).message_id; !own.empty()) {
    if (earlier.has(own)) return std::nullopt;
    return own;
  }
  const std::string base =
      std::string(name_of(topic_of(message))) + "/" + asset_of(message) + "/" + content_hash(content_of(message));
  const std::string last = earlier.last_unnumbered(topic_of(message), asset_of(message));
  if (last == base || last.starts_with(base + "#")) return std::nullopt;
  std::string id = base;
  for (int count = 2; earlier.has(id); ++count) id = base + "#" + std::to_string(count);
  return id;
}

}  // namespace sealwatch

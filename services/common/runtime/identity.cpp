#include "services/common/runtime/identity.hpp"

#include "sealwatch/core/text.hpp"
#include "sealwatch/message/id_part.hpp"
#include "sealwatch/message/replacement_id.hpp"
#include "sealwatch/message/retraction.hpp"
#include "services/common/message/json.hpp"

namespace sealwatch {
namespace {

/// The content of a message that gives no id, as it was written before headers had the last four fields, and events
/// their tests: what came before an update and comes again after it has the same id.
std::string content_of(const Message& message) {
  std::string content = to_json(without_stamps(message), JsonForm::exact);
  constexpr std::string_view kLater =
      R"(,"writer_started_ns":0,"clock_quality":"unknown","clock_error_known":false,"clock_error_s":0.0)";
  constexpr std::string_view kNoTests = R"(,"tests_known":false,"test_ids":[])";
  for (const std::string_view later : {kLater, kNoTests})
    if (const std::size_t at = content.find(later); at != std::string::npos) content.erase(at, later.size());
  return content;
}

/// What is reported with its time, where that is a replacement.
const MaintenanceEvent* as_replacement(const Message& message) {
  const auto* event = std::get_if<MaintenanceEvent>(&message);
  return event != nullptr && is_replacement(*event) && event->header.event_time_known ? event : nullptr;
}

}  // namespace

void name_replacement(Message& message) {
  const MaintenanceEvent* const event = as_replacement(message);
  if (event == nullptr || event->header.message_id.empty()) return;
  const UtcTime time{event->header.event_time_ns};
  const std::string own = event->header.message_id;
  if (may_report(own, event->asset_id, event->kind) && time_of_replacement(own) == time) return;
  header_of(message).message_id = replacement_id_of(short_part(own), event->asset_id, event->kind, time);
}

std::string id_of_refused(const Message& act) { return "refused/" + content_hash(content_of(act)); }

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
  const MaintenanceEvent* const replacement = as_replacement(message);
  const std::string end = replacement ? "/" + format_utc({replacement->header.event_time_ns}) : std::string();
  const std::string base = std::string(name_of(topic_of(message))) + "/" + asset_of(message) + "/" +
                           (replacement ? replacement->kind + "/" : std::string()) + content_hash(content_of(message));
  const std::string last = earlier.last_unnumbered(topic_of(message), asset_of(message));
  // Earlier versions kept a replacement without its kind and time.
  if (replacement && earlier.has(std::string(name_of(topic_of(message))) + "/" + asset_of(message) + "/" +
                                 content_hash(content_of(message))))
    return std::nullopt;
  if (last == base + end || last.starts_with(base + "#")) return std::nullopt;
  std::string id = base + end;
  for (int count = 2; earlier.has(id); ++count)
    id = std::string(base).append("#").append(std::to_string(count)).append(end);
  return id;
}

}  // namespace sealwatch

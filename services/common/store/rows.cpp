#include "services/common/store/rows.hpp"

#include "sealwatch/message/blank.hpp"
#include "sealwatch/message/outside.hpp"
#include "services/common/message/json.hpp"
#include "services/common/store/row_checksum.hpp"

namespace sealwatch {
namespace {

/// Of one whose samples were dropped: its columns.
Message what_is_left(Topic topic, const MessageRow& row) {
  Message message = blank_message(topic);
  Header& header = header_of(message);
  header.message_id = row.message_id;
  header.pst_id = row.pst_id;
  header.producer = kExpired;
  if (auto* block = std::get_if<SampleBlock>(&message)) block->asset_id = row.asset_id;
  if (auto* window = std::get_if<TestWindow>(&message)) window->asset_id = row.asset_id;
  return message;
}

}  // namespace

bool has_samples(const Message& message) {
  const auto* const block = std::get_if<SampleBlock>(&message);
  const auto* const window = std::get_if<TestWindow>(&message);
  return (block != nullptr && !block->samples.time_s.empty()) || (window != nullptr && !window->samples.time_s.empty());
}

Message without_samples(Message message) {
  if (auto* block = std::get_if<SampleBlock>(&message)) block->samples = {};
  if (auto* window = std::get_if<TestWindow>(&message)) window->samples = {};
  Header& header = header_of(message);
  if (!is_expired(header.producer)) header.producer.insert(0, kExpired);
  return message;
}

bool is_as_written(const MessageRow& output) {
  const bool is_known = !output.checksum.empty() && output.checksum != kDamaged && output.checksum != kExpiredRow;
  return !is_known ||
         output.checksum == checksum_of_output(output.order, output.topic, output.sequence, output.message_id,
                                               output.asset_id, output.pst_id, output.payload);
}

Message message_of(const MessageRow& row, const std::string& journal) {
  const auto damaged = [&](const std::string& what) {
    return Error{.file = journal,
                 .place = "message " + std::to_string(row.order),
                 .value = row.topic,
                 .rule = what,
                 .advice = "restore a backup of the journal"};
  };
  const auto topic = value_of<Topic>(row.topic);
  if (!topic) throw damaged("is not a topic that this program knows");
  Result<Message> message = message_from_json(*topic, row.payload);
  if (row.checksum == kExpiredRow && !message) return what_is_left(*topic, row);
  if (!message) throw damaged(message.error().describe());
  return std::move(*message);
}

std::vector<MessageRow> rows_of(soci::session& sql, const std::string& query, long long after) {
  std::vector<MessageRow> rows;
  MessageRow row;
  soci::statement statement =
      (sql.prepare << query, soci::into(row.order), soci::into(row.topic), soci::into(row.payload),
       soci::into(row.sequence), soci::into(row.published), soci::into(row.message_id), soci::into(row.asset_id),
       soci::into(row.pst_id), soci::into(row.checksum), soci::use(after, "after"));
  statement.execute();
  while (statement.fetch()) rows.push_back(row);
  return rows;
}

}  // namespace sealwatch

#include "services/common/store/statements.hpp"

#include "services/common/message/json.hpp"
#include "services/common/store/row_checksum.hpp"

namespace sealwatch {

using soci::into;
using soci::use;

namespace {

/// Whether there is a row. Reads to the end: a query that is left open holds SQLite's log as it was then, which could
/// never be emptied.
bool read_row(soci::statement& query) {
  const bool found = query.execute(true);
  while (found && query.fetch()) continue;
  return found;
}

}  // namespace

JournalStatements::JournalStatements(soci::session& sql)
    : find_input_((sql.prepare << "SELECT asset_id FROM inputs WHERE message_id = :message", into(asset_id_),
                   use(message_id_, "message"))),
      find_output_((sql.prepare << "SELECT asset_id FROM outputs WHERE message_id = :message", into(asset_id_),
                    use(message_id_, "message"))),
      find_unnumbered_((sql.prepare << "SELECT message_id FROM inputs WHERE topic = :topic AND asset_id = :asset"
                                       " AND sequence = 0 ORDER BY receipt DESC LIMIT 1",
                        into(message_id_), use(topic_, "topic"), use(asset_id_, "asset"))),
      insert_input_((sql.prepare << "INSERT INTO inputs(receipt, topic, writer_id, sequence, message_id, asset_id,"
                                    " pst_id, received, consumed, payload, checksum) VALUES(:receipt, :topic,"
                                    " :writer, :sequence, :message, :asset, :pst, :received, :consumed, :payload,"
                                    " :checksum)",
                     use(order_, "receipt"), use(topic_, "topic"), use(writer_id_, "writer"),
                     use(sequence_, "sequence"), use(message_id_, "message"), use(asset_id_, "asset"),
                     use(pst_id_, "pst"), use(time_, "received"), use(consumed_, "consumed"),
                     use(payload_, payload_there_, "payload"), use(checksum_, payload_there_, "checksum"))),
      consume_input_((sql.prepare << "UPDATE inputs SET consumed = 1, payload = NULL, checksum = NULL"
                                     " WHERE message_id = :message AND consumed = 0",
                      use(message_id_, "message"))),
      insert_output_((sql.prepare << "INSERT INTO outputs(ordinal, topic, sequence, message_id, asset_id, pst_id,"
                                     " published, payload, checksum) VALUES(:ordinal, :topic, :sequence,"
                                     " :message, :asset, :pst, :published, :payload, :checksum)"
                                     " ON CONFLICT(message_id) DO NOTHING",
                      use(order_, "ordinal"), use(topic_, "topic"), use(sequence_, "sequence"),
                      use(message_id_, "message"), use(asset_id_, "asset"), use(pst_id_, "pst"),
                      use(time_, "published"), use(payload_, payload_there_, "payload"), use(checksum_, "checksum"))),
      upsert_position_((sql.prepare << "INSERT INTO positions(topic, writer_id, sequence, checksum) VALUES(:topic,"
                                       " :writer, :sequence, :checksum) ON CONFLICT(topic, writer_id)"
                                       " DO UPDATE SET sequence = excluded.sequence, checksum = excluded.checksum",
                        use(topic_, "topic"), use(writer_id_, "writer"), use(sequence_, "sequence"),
                        use(checksum_, "checksum"))) {}

std::optional<std::string> JournalStatements::asset_of_input(const std::string& message_id) {
  message_id_ = message_id;
  return read_row(find_input_) ? std::optional(asset_id_) : std::nullopt;
}

std::optional<std::string> JournalStatements::asset_of_output(const std::string& message_id) {
  message_id_ = message_id;
  return read_row(find_output_) ? std::optional(asset_id_) : std::nullopt;
}

std::string JournalStatements::last_unnumbered_input(Topic topic, const std::string& asset_id) {
  topic_ = name_of(topic);
  asset_id_ = asset_id;
  return read_row(find_unnumbered_) ? message_id_ : std::string();
}

void JournalStatements::bind_message(const Message& message) {
  const Header& header = header_of(message);
  topic_ = name_of(topic_of(message));
  message_id_ = header.message_id;
  asset_id_ = asset_of(message);
  pst_id_ = header.pst_id;
}

void JournalStatements::add_input(long long receipt, const Message& message, const StreamPosition& stream,
                                  UtcTime received, InputState state) {
  bind_message(message);
  order_ = receipt;
  writer_id_ = stream.writer_id;
  sequence_ = static_cast<long long>(stream.sequence);
  time_ = received.nanoseconds;
  consumed_ = static_cast<int>(state);
  const bool kept = state != InputState::consumed;
  payload_ = kept ? to_json(message, JsonForm::exact) : std::string();
  payload_there_ = kept ? soci::i_ok : soci::i_null;
  checksum_ = kept ? checksum_of_input(order_, topic_, message_id_, asset_id_, pst_id_, payload_) : std::string();
  insert_input_.execute(true);
}

bool JournalStatements::consume(const std::string& message_id) {
  message_id_ = message_id;
  consume_input_.execute(true);
  return consume_input_.get_affected_rows() > 0;
}

bool JournalStatements::add_output(long long ordinal, const Message& message, std::uint64_t sequence,
                                   UtcTime publishing_time) {
  bind_message(message);
  order_ = ordinal;
  sequence_ = static_cast<long long>(sequence);
  time_ = publishing_time.nanoseconds;
  payload_ = to_json(message, JsonForm::exact);
  payload_there_ = soci::i_ok;
  checksum_ = checksum_of_output(order_, topic_, sequence_, message_id_, asset_id_, pst_id_, payload_);
  insert_output_.execute(true);
  return insert_output_.get_affected_rows() > 0;
}

void JournalStatements::set_position(const StreamPosition& position) {
  topic_ = position.topic;
  writer_id_ = position.writer_id;
  sequence_ = static_cast<long long>(position.sequence);
  checksum_ = checksum_of_position(topic_, writer_id_, sequence_);
  upsert_position_.execute(true);
}

}  // namespace sealwatch

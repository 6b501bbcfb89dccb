#include "services/common/store/journal.hpp"

#include "sealwatch/message/blank.hpp"
#include "sealwatch/message/id_part.hpp"
#include "sealwatch/message/outside.hpp"
#include "services/common/store/database.hpp"
#include "services/common/store/log_sync.hpp"
#include "services/common/store/row_checksum.hpp"
#include "services/common/store/rows.hpp"

namespace sealwatch {
namespace {

using soci::into;
using soci::use;

/// Messages read at once: bounds memory, as one window of a test has some hundred kilobytes.
constexpr int kPage = 16;

constexpr const char* kInput =
    "SELECT receipt, topic, coalesce(payload, ''), sequence, received, message_id, asset_id, pst_id,"
    " coalesce(checksum, '') FROM inputs WHERE ";

std::string topic_name(Topic topic) { return std::string(name_of(topic)); }

Message stamped(Message message, const std::string& writer_id, std::uint64_t sequence, long long published) {
  Header& header = header_of(message);
  header.writer_id = writer_id;
  header.stream_sequence = sequence;
  header.publishing_time_ns = published;
  return message;
}

/// In place of a row that is damaged: its readers count on, and refuse it.
Message placeholder(const MessageRow& row) {
  const auto topic = value_of<Topic>(row.topic);
  Message message = blank_message(topic.value_or(Topic::sample_block));
  header_of(message).message_id = std::string(kDamagedMessage) + row.topic + "/" + std::to_string(row.sequence);
  return message;
}

}  // namespace

Journal::Journal(std::unique_ptr<Database> database) : database_(std::move(database)) {}
Journal::~Journal() = default;
Journal::Journal(Journal&& other) noexcept = default;
Journal& Journal::operator=(Journal&& other) noexcept = default;

const std::string& Journal::writer_id() const { return database_->writer_id; }
const std::map<Topic, std::uint64_t>& Journal::written() const { return database_->written; }
UtcTime Journal::last_used() const { return {database_->last_used_ns}; }
std::uint64_t Journal::open_inputs() const { return database_->open_inputs; }

std::function<bool()> Journal::to_disk() const {
  if (!database_->checkpointer) return [] { return true; };
  return [log = std::make_shared<LogSync>(database_->file + "-wal")] { return log->sync(); };
}

Status Journal::for_each_page(const std::string& query, const Visitor& visit) {
  const bool of_outputs = query.starts_with(kOutput);  // of a damaged test they are concluded again from its inputs
  long long after = 0;
  for (;;) {
    std::vector<Message> page;
    auto rows = database_->guard("reading messages", [&] {
      const std::vector<MessageRow> read = rows_of(database_->sql, query + std::to_string(kPage), after);
      for (const MessageRow& row : read) {
        after = row.order;
        if (row.checksum == kDamaged) continue;
        if (of_outputs && database_->damaged_tests.contains({row.asset_id, row.pst_id})) continue;
        if (of_outputs) database_->check(row);
        page.push_back(message_of(row, database_->name));
      }
      return read.size();
    });
    if (!rows) return fail(rows.error());
    if (*rows == 0) return {};
    for (const Message& message : page)
      if (Status visited = visit(message); !visited) return visited;
  }
}

Status Journal::for_each_output(const Visitor& visit) {
  return for_each_page(std::string(kOutput) + "ordinal > :after ORDER BY ordinal LIMIT ", visit);
}

Status Journal::for_each_open_input(const Visitor& visit) {
  return for_each_page(std::string(kInput) + "consumed = 0 AND receipt > :after ORDER BY receipt LIMIT ", visit);
}

Result<std::vector<Message>> Journal::outputs(Topic topic, std::uint64_t first, std::uint64_t last, std::size_t most) {
  return database_->guard("reading messages to send again", [&] {
    const std::string query = std::string(kOutput) + "sequence > :after AND sequence <= " + std::to_string(last) +
                              " AND topic = '" + topic_name(topic) + "' ORDER BY sequence LIMIT " +
                              std::to_string(most);
    std::vector<Message> messages;
    for (const MessageRow& row : rows_of(database_->sql, query, static_cast<long long>(first) - 1)) {
      database_->check(row);
      messages.push_back(stamped(row.checksum == kDamaged ? placeholder(row) : message_of(row, database_->name),
                                 writer_id(), static_cast<std::uint64_t>(row.sequence), row.published));
    }
    return messages;
  });
}

Result<bool> Journal::has_input(const std::string& message_id) {
  const auto asset = asset_of_input(message_id);
  return asset ? Result<bool>(asset->has_value()) : fail(asset.error());
}

Result<std::optional<std::string>> Journal::asset_of_input(const std::string& message_id) {
  return database_->guard("looking for an input", [&] { return database_->statements->asset_of_input(message_id); });
}

Result<std::string> Journal::last_unnumbered_input(Topic topic, const std::string& asset_id) {
  return database_->guard("looking for the last input",
                          [&] { return database_->statements->last_unnumbered_input(topic, asset_id); });
}

Result<std::vector<StreamPosition>> Journal::positions() {
  return database_->guard("reading positions", [&] {
    std::vector<StreamPosition> positions;
    std::string topic;
    std::string writer;
    long long sequence = 0;
    soci::statement statement =
        (database_->sql.prepare << "SELECT topic, writer_id, sequence FROM positions ORDER BY topic, writer_id",
         into(topic), into(writer), into(sequence));
    statement.execute();
    while (statement.fetch()) positions.push_back({topic, writer, static_cast<std::uint64_t>(sequence)});
    return positions;
  });
}

Status Journal::is_in_place() {
  return database_->guard("looking for the journal", [&] {
    database_->check_in_place();
    database_->remember_now_and_then();
  });
}

Status Journal::begin(Survives survives) {
  return database_->guard("beginning a batch", [&] {
    database_->begin(survives);
    database_->batch_rows = 0;
  });
}

Status Journal::commit() {
  return database_->guard("committing a batch", [&] {
    database_->sql.commit();
    database_->has_synced = true;
    database_->committed = database_->last_ordinal;
    if (database_->checkpointer) database_->checkpointer->committed(database_->batch_rows);
  });
}

void Journal::rollback() {
  // A failure here changes nothing: the transaction that is not committed does not count.
  (void)database_->guard("giving up a batch", [&] {
    database_->sql.rollback();
    database_->load_counters();
  });
}

Status Journal::add_input(const Message& message, UtcTime received, bool consumed) {
  const Header& header = header_of(message);
  return add_input(message, {{}, header.writer_id, header.stream_sequence}, received,
                   consumed ? InputState::consumed : InputState::open);
}

Status Journal::add_input(const Message& message, const StreamPosition& stream, UtcTime received, InputState state) {
  return database_->guard("keeping an input", [&] {
    database_->statements->add_input(++database_->last_receipt, message, stream, received, state);
    ++database_->batch_rows;
    if (state == InputState::open) ++database_->open_inputs;
  });
}

Status Journal::consume(const std::string& message_id) {
  return database_->guard("marking an input as consumed", [&] {
    if (!database_->statements->consume(message_id)) return;
    --database_->open_inputs;
    ++database_->batch_rows;
  });
}

Result<std::optional<Message>> Journal::add_output(Message message, UtcTime publishing_time) {
  return database_->guard("keeping an output", [&]() -> std::optional<Message> {
    const std::uint64_t sequence = database_->written[topic_of(message)] + 1;
    message = stamped(std::move(message), {}, 0, 0);
    const auto owner = database_->statements->asset_of_output(header_of(message).message_id);
    if (owner && *owner != asset_of(message)) header_of(message).message_id = id_beside_another_asset(message);
    if (auto mended = database_->fill_place(message, publishing_time)) return mended;
    if (!database_->statements->add_output(database_->last_ordinal + 1, message, sequence, publishing_time))
      return std::nullopt;
    ++database_->last_ordinal;
    ++database_->batch_rows;
    database_->written[topic_of(message)] = sequence;
    return stamped(std::move(message), writer_id(), sequence, publishing_time.nanoseconds);
  });
}

Status Journal::set_position(const StreamPosition& position) {
  return database_->guard("keeping a position", [&] { database_->statements->set_position(position); });
}

}  // namespace sealwatch

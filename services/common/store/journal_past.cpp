// What a journal tells of one asset's past, which is read when somebody needs it: a start does not wait for the history
// of all. What is read is checked.
#include <map>

#include "sealwatch/message/blank.hpp"
#include "services/common/store/database.hpp"
#include "services/common/store/row_checksum.hpp"

namespace sealwatch {

using soci::into;
using soci::use;

namespace {

/// An output, as the index of an asset's outputs has it.
struct Entry {
  long long ordinal = 0;
  std::string pst_id;
  std::string topic;
};

std::vector<Entry> entries_of(soci::session& sql, const std::string& asset_id) {
  std::vector<Entry> entries;
  Entry entry;
  soci::statement statement =
      (sql.prepare << "SELECT ordinal, pst_id, topic FROM outputs WHERE asset_id = :asset ORDER BY ordinal",
       use(asset_id, "asset"), into(entry.ordinal), into(entry.pst_id), into(entry.topic));
  statement.execute();
  while (statement.fetch()) entries.push_back(entry);
  return entries;
}

/// Reads outputs one by one, by their ordinals, and compares them with what the index says of them: rows have
/// checksums, the index has none.
class OutputReader {
 public:
  OutputReader(soci::session& sql, std::string asset_id)
      : asset_id_(std::move(asset_id)),
        whole_((sql.prepare << std::string(kOutput) + "ordinal = :ordinal", into(row_.order), into(row_.topic),
                into(row_.payload), into(row_.sequence), into(row_.published), into(row_.message_id),
                into(row_.asset_id), into(row_.pst_id), into(row_.checksum), use(ordinal_, "ordinal"))),
        place_((sql.prepare << "SELECT sequence, published, message_id, asset_id, pst_id, topic FROM outputs"
                               " WHERE ordinal = :ordinal",
                into(row_.sequence), into(row_.published), into(row_.message_id), into(row_.asset_id),
                into(row_.pst_id), into(row_.topic), use(ordinal_, "ordinal"))) {}

  /// nullptr: no such output is in the table.
  const MessageRow* read(const Entry& entry) { return run(whole_, entry); }
  [[nodiscard]] const MessageRow& row() const { return row_; }
  /// Its numbers and its ids alone.
  const MessageRow* read_place(const Entry& entry) { return run(place_, entry); }

 private:
  const MessageRow* run(soci::statement& query, const Entry& entry) {
    ordinal_ = entry.ordinal;
    const bool found = query.execute(true);
    for (bool more = found; more; more = query.fetch()) continue;  // to the end, or it would hold the log as it is now
    const bool same = row_.asset_id == asset_id_ && row_.pst_id == entry.pst_id && row_.topic == entry.topic;
    return found && same ? &row_ : nullptr;
  }

  std::string asset_id_;
  long long ordinal_ = 0;
  MessageRow row_;
  soci::statement whole_;
  soci::statement place_;
};

/// A message of another topic about the test of `last`: its id, and when the test was.
Message shadow_of(const Message& last, const Entry& entry, const MessageRow& row) {
  Message shadow = blank_message(value_of<Topic>(entry.topic).value_or(topic_of(last)));
  header_of(shadow) = header_of(last);
  header_of(shadow).message_id = row.message_id;
  std::visit([&](auto& content) { content.asset_id = asset_of(last); }, shadow);
  return shadow;
}

}  // namespace

Status Journal::for_each_output_of(const std::string& asset_id, const NumberedVisitor& visit,
                                   const TellsAll& tells_all) {
  struct Last {
    Entry entry = {};
    std::optional<Message> told = {};  ///< where it tells all
  };
  std::vector<std::pair<Message, Place>> past;
  const auto read = database_->guard("reading an asset's past", [&] {
    const std::vector<Entry> entries = entries_of(database_->sql, asset_id);
    OutputReader reader(database_->sql, asset_id);
    const auto of_index = [&](const MessageRow* row, const Entry& entry) -> const MessageRow& {
      if (row == nullptr) database_->must_be_mended(entry.ordinal, asset_id);
      return *row;
    };
    const auto read_whole = [&](const Entry& entry) -> std::optional<Message> {
      const MessageRow& row = of_index(reader.read(entry), entry);
      if (row.checksum == kDamaged || database_->damaged_tests.contains({row.asset_id, row.pst_id}))
        return std::nullopt;
      database_->check(row);
      return message_of(row, database_->name);
    };
    const auto keep = [&past, &reader](Message message) {
      const MessageRow& row = reader.row();
      past.emplace_back(std::move(message), Place{static_cast<std::uint64_t>(row.sequence), UtcTime{row.published}});
    };
    std::map<std::string, Last> tests;
    for (const Entry& entry : entries) tests[entry.pst_id].entry = entry;
    tests.erase("");  // of no test
    for (auto& [pst_id, last] : tests)
      if (auto message = read_whole(last.entry); message && tells_all(*message)) last.told = std::move(message);
    for (const Entry& entry : entries) {
      const auto test = tests.find(entry.pst_id);
      const Message* const last = test == tests.end() || !test->second.told ? nullptr : &*test->second.told;
      if (last == nullptr) {
        if (auto message = read_whole(entry)) keep(std::move(*message));
      } else if (const MessageRow& row = of_index(reader.read_place(entry), entry);
                 entry.ordinal == test->second.entry.ordinal) {
        keep(*last);
      } else if (entry.topic != name_of(topic_of(*last))) {
        keep(shadow_of(*last, entry, row));
      }
    }
  });
  if (!read) return fail(read.error());
  for (const auto& [message, place] : past)
    if (Status visited = visit(message, place); !visited) return visited;
  return {};
}

Result<std::vector<std::string>> Journal::assets() {
  return database_->guard("looking for assets", [&] {
    std::vector<std::string> found;
    std::string asset_id;
    soci::statement waiting =
        (database_->sql.prepare << "SELECT DISTINCT asset_id FROM inputs WHERE consumed = 0 ORDER BY asset_id",
         into(asset_id));
    waiting.execute();
    while (waiting.fetch()) found.push_back(asset_id);
    const std::set<std::string> with_inputs(found.begin(), found.end());
    // From one to the next by the index: what lies between, the history, is not looked at.
    soci::indicator there = soci::i_null;
    std::string next;
    database_->sql << "SELECT min(asset_id) FROM outputs", into(next, there);
    while (there == soci::i_ok) {
      if (!with_inputs.contains(next)) found.push_back(next);
      const std::string last = next;
      database_->sql << "SELECT min(asset_id) FROM outputs WHERE asset_id > :last", use(last, "last"),
          into(next, there);
    }
    return found;
  });
}

}  // namespace sealwatch

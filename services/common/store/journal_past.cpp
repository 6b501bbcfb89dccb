// What a journal tells of one asset's past, which is read when somebody needs it: a start does not wait for the history
// of all. What is read is checked, and the rest is looked at little by little.
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

/// Outputs that are looked at at once: some of them hold samples.
constexpr int kFew = 4;

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

/// Reads outputs one by one, by their ordinals.
class OutputReader {
 public:
  explicit OutputReader(soci::session& sql)
      : whole_((sql.prepare << std::string(kOutput) + "ordinal = :ordinal", into(row_.order), into(row_.topic),
                into(row_.payload), into(row_.sequence), into(row_.published), into(row_.message_id),
                into(row_.asset_id), into(row_.pst_id), into(row_.checksum), use(ordinal_, "ordinal"))),
        place_((sql.prepare << "SELECT sequence, published, message_id FROM outputs WHERE ordinal = :ordinal",
                into(row_.sequence), into(row_.published), into(row_.message_id), use(ordinal_, "ordinal"))) {}

  const MessageRow& read(long long ordinal) { return run(whole_, ordinal); }
  [[nodiscard]] const MessageRow& row() const { return row_; }
  /// Its numbers and its id alone.
  [[nodiscard]] const MessageRow& read_place(long long ordinal) { return run(place_, ordinal); }

 private:
  const MessageRow& run(soci::statement& query, long long ordinal) {
    ordinal_ = ordinal;
    bool found = query.execute(true);
    while (found && query.fetch()) continue;  // to the end, or it would hold the log as it is now
    return row_;
  }

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
    long long ordinal = 0;
    std::optional<Message> told = {};  ///< where it tells all
  };
  std::vector<std::pair<Message, Place>> past;
  const auto read = database_->guard("reading an asset's past", [&] {
    const std::vector<Entry> entries = entries_of(database_->sql, asset_id);
    OutputReader reader(database_->sql);
    const auto read_whole = [&](const Entry& entry) -> std::optional<Message> {
      const MessageRow& row = reader.read(entry.ordinal);
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
    for (const Entry& entry : entries) tests[entry.pst_id].ordinal = entry.ordinal;
    tests.erase("");  // of no test
    for (auto& [pst_id, last] : tests)
      if (auto message = read_whole({last.ordinal, {}, {}}); message && tells_all(*message))
        last.told = std::move(message);
    for (const Entry& entry : entries) {
      const auto test = tests.find(entry.pst_id);
      const Message* const last = test == tests.end() || !test->second.told ? nullptr : &*test->second.told;
      if (last == nullptr) {
        if (auto message = read_whole(entry)) keep(std::move(*message));
      } else if (const MessageRow& row = reader.read_place(entry.ordinal); entry.ordinal == test->second.ordinal) {
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

Result<bool> Journal::check_some() {
  return database_->guard("looking for damage", [&] {
    const std::string query = std::string(kOutput) + "ordinal > :after ORDER BY ordinal LIMIT " + std::to_string(kFew);
    const std::vector<MessageRow> rows = rows_of(database_->sql, query, database_->checked);
    for (const MessageRow& row : rows) {
      database_->check(row);
      database_->checked = row.order;
    }
    return !rows.empty();
  });
}

void Journal::Database::check(const MessageRow& output) {
  const bool is_known = !output.checksum.empty() && output.checksum != kDamaged && output.checksum != kExpiredRow;
  if (!is_known) return;
  if (output.checksum == checksum_of_output(output.order, output.topic, output.sequence, output.message_id,
                                            output.asset_id, output.pst_id, output.payload))
    return;
  set_meta(kToBeMended, "1");
  throw Error{.file = name,
              .place = "output " + std::to_string(output.order),
              .value = output.message_id,
              .rule = "is not as it was written: a disk or a memory turned a bit",
              .advice = "the service starts again, and makes it anew from the neighbours' messages"};
}

}  // namespace sealwatch

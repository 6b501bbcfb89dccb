// What a journal tells of one asset's past, which is read when somebody needs it: a start does not wait for the history
// of all. What is read is checked.
#include <algorithm>
#include <functional>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "sealwatch/message/blank.hpp"
#include "services/common/store/database.hpp"
#include "services/common/store/packed_past.hpp"
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

std::vector<Entry> entries_of(soci::session& sql, const std::string& asset_id, long long behind) {
  std::vector<Entry> entries;
  Entry entry;
  soci::statement statement =
      (sql.prepare << "SELECT ordinal, pst_id, topic FROM outputs WHERE asset_id = :asset AND ordinal > :behind"
                      " ORDER BY ordinal",
       use(asset_id, "asset"), use(behind, "behind"), into(entry.ordinal), into(entry.pst_id), into(entry.topic));
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

/// What an output that is remembered was read from.
struct Read {
  std::size_t entry = 0;  ///< its index
  bool is_told = false;   ///< it tells all of its test
  PastOutput output;
};

/// So many that are read from JSON are packed at once.
constexpr std::size_t kWorthPacking = 16;

/// Tests of which more may come are not packed: the last one, one that is not told and has samples, which would take as
/// much room again, and those among whose outputs one of these begins. Returns how many entries are of others.
std::size_t complete_entries(const std::vector<Entry>& entries, const std::vector<Read>& read) {
  std::map<std::string_view, std::size_t> first;
  for (std::size_t k = 0; k < entries.size(); ++k)
    if (!entries[k].pst_id.empty()) first.try_emplace(entries[k].pst_id, k);
  const auto begin_of = [&](const Entry& entry, std::size_t k) {
    return entry.pst_id.empty() ? k : first.at(entry.pst_id);
  };
  std::size_t complete = entries.empty() ? 0 : begin_of(entries.back(), entries.size() - 1);
  for (const Read& one : read)
    if (!one.is_told && has_samples(one.output.message))
      complete = std::min(complete, begin_of(entries[one.entry], one.entry));
  for (std::size_t k = entries.size(); k-- > complete;) complete = std::min(complete, begin_of(entries[k], k));
  return complete;
}

/// Whether something came of a test that is packed: by what it is told may have changed.
bool goes_on_with_packed(const std::vector<Entry>& entries, const PackedPast& packed) {
  std::set<std::string_view> tests;
  if (!entries.empty())
    for (const PastOutput& output : packed.outputs) tests.insert(header_of(output.message).pst_id);
  return std::ranges::any_of(entries,
                             [&](const Entry& entry) { return !entry.pst_id.empty() && tests.contains(entry.pst_id); });
}

void pack(soci::session& sql, const PackedOf& whose, long long behind, const std::vector<Entry>& entries,
          const std::vector<Read>& read) {
  const std::size_t complete = complete_entries(entries, read);
  std::vector<PastOutput> remembered;
  for (const Read& one : read) {
    if (one.entry >= complete) break;
    const Message& message = one.output.message;
    remembered.push_back({has_samples(message) ? without_samples(message) : message, one.output.place});
  }
  if (remembered.size() < kWorthPacking) return;
  pack_more(sql, whose, behind, entries[complete - 1].ordinal, static_cast<long long>(complete), remembered);
}

/// Reads from JSON, as far as the past is not packed.
class PastReader {
 public:
  /// The row that an entry of the index says, which may be missing; and its message, none where it is not to be read.
  struct Checks {
    std::function<const MessageRow&(const MessageRow*, const Entry&)> of_index;
    std::function<std::optional<Message>(const MessageRow&)> message_in;
  };

  PastReader(soci::session& sql, const std::string& asset_id, Checks checks)
      : reader_(sql, asset_id), checks_(std::move(checks)) {}

  std::vector<Read> read(const std::vector<Entry>& entries, const Journal::TellsAll& tells_all) {
    for (const Entry& entry : entries) tests_[entry.pst_id].entry = entry;
    tests_.erase("");  // of no test
    for (auto& [pst_id, last] : tests_)
      if (auto message = read_whole(last.entry); message && tells_all(*message)) last.told = std::move(message);
    for (std::size_t k = 0; k < entries.size(); ++k) read(entries[k], k);
    return std::move(read_);
  }

 private:
  struct Last {
    Entry entry = {};
    std::optional<Message> told = {};  ///< where it tells all
  };

  void read(const Entry& entry, std::size_t index) {
    const auto test = tests_.find(entry.pst_id);
    const Message* const last = test == tests_.end() || !test->second.told ? nullptr : &*test->second.told;
    if (last == nullptr) {
      if (auto message = read_whole(entry)) keep(index, false, std::move(*message));
    } else if (const MessageRow& row = checks_.of_index(reader_.read_place(entry), entry);
               entry.ordinal == test->second.entry.ordinal) {
      keep(index, true, *last);
    } else if (entry.topic != name_of(topic_of(*last))) {
      keep(index, true, shadow_of(*last, entry, row));
    }
  }

  std::optional<Message> read_whole(const Entry& entry) {
    return checks_.message_in(checks_.of_index(reader_.read(entry), entry));
  }

  void keep(std::size_t index, bool is_told, Message message) {
    const MessageRow& row = reader_.row();
    const Journal::Place place{static_cast<std::uint64_t>(row.sequence), UtcTime{row.published}};
    read_.push_back({index, is_told, {std::move(message), place}});
  }

  OutputReader reader_;
  Checks checks_;
  std::map<std::string, Last> tests_;
  std::vector<Read> read_;
};

}  // namespace

bool Journal::Database::has_damaged_test(const std::string& asset_id) const {
  const auto first = damaged_tests.lower_bound({asset_id, ""});
  return first != damaged_tests.end() && first->first == asset_id;
}

/// Where SQLite cannot find its way in the table, this process does without: nothing is lost with it.
PackedPast Journal::Database::packed_past_of(const std::string& asset_id) try {
  if (!packs || has_damaged_test(asset_id)) return {};
  PackedPast past = packed_past(sql, {asset_id, packs_for});
  if (!past.refused.empty() && packed_refused.empty()) packed_refused = asset_id + ": " + past.refused;
  return past;
} catch (const soci::soci_error& error) {
  if (!is_file()) throw;
  packs = false;
  packed_refused = asset_id + ": table packed_outputs cannot be read: " + error.what();
  return {};
}

void Journal::pack_for(const std::string& version) { database_->packs_for = version; }

std::optional<std::string> Journal::take_packed_refused() {
  if (database_->packed_refused.empty() || std::exchange(database_->told_packed_refused, true)) return std::nullopt;
  return database_->packed_refused;
}

Status Journal::for_each_output_of(const std::string& asset_id, const NumberedVisitor& visit,
                                   const TellsAll& tells_all) {
  const PastReader::Checks checks = {
      [&](const MessageRow* row, const Entry& entry) -> const MessageRow& {
        if (row == nullptr) database_->must_be_mended(entry.ordinal, asset_id);
        return *row;
      },
      [&](const MessageRow& row) -> std::optional<Message> {
        if (row.checksum == kDamaged || database_->damaged_tests.contains({row.asset_id, row.pst_id}))
          return std::nullopt;
        database_->check(row);
        return message_of(row, database_->name);
      }};
  const auto past = database_->guard("reading an asset's past", [&] {
    PackedPast packed = database_->packed_past_of(asset_id);
    std::vector<Entry> entries = entries_of(database_->sql, asset_id, packed.ends);
    if (goes_on_with_packed(entries, packed)) {
      packed = {};
      entries = entries_of(database_->sql, asset_id, 0);
    }
    std::vector<Read> read = PastReader(database_->sql, asset_id, checks).read(entries, tells_all);
    if (read.size() >= kWorthPacking && database_->packs && !database_->has_damaged_test(asset_id)) {
      pack(database_->sql, {asset_id, database_->packs_for}, packed.ends, entries, read);
      if (database_->checkpointer) database_->checkpointer->committed(read.size());
    }
    for (Read& one : read) packed.outputs.push_back(std::move(one.output));
    return std::move(packed.outputs);
  });
  if (!past) return fail(past.error());
  for (const auto& [message, place] : *past)
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

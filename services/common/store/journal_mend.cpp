// Rows that are not as they were written: a disk or a memory turned a bit. They are found when the journal is opened or,
// in a long history, when they are read or looked at later, which ends the service: it then opens the journal again. They
// are never used, and wherever possible made again:
//
//   index        made anew from its rows, which have checksums
//   position     from the numbers of the inputs, which are kept for ever
//   output       its place stays empty; the inputs of its test are forgotten, come again from the neighbours' journals,
//                and what is concluded from them anew fills the place
//   open input   forgotten, and comes again; what came from outside does not, and is set aside with that reason
//   quarantine   what it set aside is tried again
//
// What cannot be made again is an alarm (quarantine, "damaged") until somebody has seen it. A consumed input is only an
// id that prevents doubles; a record of acts shows by itself that it was changed.
#include <chrono>
#include <map>
#include <stdexcept>
#include <string_view>

#include "sealwatch/message/outside.hpp"
#include "services/common/message/json.hpp"
#include "services/common/store/audit_rows.hpp"
#include "services/common/store/database.hpp"
#include "services/common/store/row_checksum.hpp"

namespace sealwatch {
namespace {

using soci::into;
using soci::use;
using std::chrono::steady_clock;

struct DamagedRow {
  long long order = 0;
  std::string topic;
  std::string writer_id;
  long long sequence = 0;
  std::string message_id;
  std::string asset_id;
  std::string pst_id;
  std::string payload;
  std::string checksum;
  std::string expected;  ///< checksum of what stands in the row
};

/// How long a start looks at outputs, and at how many: those without samples are passed over, and no time is looked at
/// meanwhile. The rest is looked at while the service runs (Journal::check_some).
constexpr std::chrono::milliseconds kLook{500};
constexpr const char* kSomeOutputs = "(SELECT * FROM outputs ORDER BY ordinal LIMIT 1000) AS earliest";

/// Rows of these outputs, or of inputs where none are named, that are not as they were written; those of version 1 have
/// no checksum. Up to `end`: `looked_at` is the last.
std::vector<DamagedRow> damaged_rows(soci::session& sql, const std::string& outputs, steady_clock::time_point end,
                                     long long& looked_at) {
  const std::string query =
      !outputs.empty()
          ? "SELECT ordinal, topic, '', sequence, message_id, asset_id, pst_id, payload, checksum FROM " + outputs +
                " WHERE checksum NOT IN ('damaged', 'expired') ORDER BY ordinal"
          : "SELECT receipt, topic, writer_id, sequence, message_id, asset_id, pst_id, payload, checksum FROM inputs"
            " WHERE payload IS NOT NULL OR consumed <> 1";
  DamagedRow row;
  std::string& payload = row.payload;
  std::string& checksum = row.checksum;
  soci::indicator has_payload = soci::i_null;
  soci::indicator has_checksum = soci::i_null;
  soci::statement statement = (sql.prepare << query, into(row.order), into(row.topic), into(row.writer_id),
                               into(row.sequence), into(row.message_id), into(row.asset_id), into(row.pst_id),
                               into(payload, has_payload), into(checksum, has_checksum));
  std::vector<DamagedRow> damaged;
  statement.execute();
  while (steady_clock::now() < end && statement.fetch()) {
    looked_at = row.order;
    const bool known = has_payload == soci::i_ok && has_checksum != soci::i_ok;
    if (known) continue;
    const std::string expected =
        !outputs.empty()
            ? checksum_of_output(row.order, row.topic, row.sequence, row.message_id, row.asset_id, row.pst_id, payload)
            : checksum_of_input(row.order, row.topic, row.message_id, row.asset_id, row.pst_id, payload);
    if (has_payload == soci::i_ok && checksum == expected) continue;
    row.expected = has_payload == soci::i_ok ? expected : std::string();
    damaged.push_back(row);
  }
  return damaged;
}

/// One bit of the row changes many characters of its checksum: where one is off, that is what was turned.
bool is_one_character_off(const std::string& a, const std::string& b) {
  if (a.size() != b.size()) return false;
  std::size_t off = 0;
  for (std::size_t k = 0; k < a.size(); ++k) off += a[k] == b[k] ? 0 : 1;
  return off == 1;
}

/// The row is whole, and its checksum is not.
bool put_checksum_right(soci::session& sql, const DamagedRow& row, bool output) {
  if (!is_one_character_off(row.checksum, row.expected)) return false;
  sql << (output ? "UPDATE outputs SET checksum = :checksum WHERE ordinal = :order"
                 : "UPDATE inputs SET checksum = :checksum WHERE receipt = :order"),
      use(row.expected, "checksum"), use(row.order, "order");
  return true;
}

/// Where a column is off and not the message, the message says what stood in it: the checksum agrees.
bool put_right(soci::session& sql, const DamagedRow& row) {
  const auto topic = value_of<Topic>(row.topic);
  const Result<Message> message = topic ? message_from_json(*topic, row.payload) : fail("of an unknown topic");
  if (!message) return false;
  const std::string id = header_of(*message).message_id, asset = asset_of(*message), pst = header_of(*message).pst_id;
  if (checksum_of_output(row.order, row.topic, row.sequence, id, asset, pst, row.payload) != row.checksum) return false;
  sql << "UPDATE outputs SET message_id = :id, asset_id = :asset, pst_id = :pst WHERE ordinal = :ordinal",
      use(id, "id"), use(asset, "asset"), use(pst, "pst"), use(row.order, "ordinal");
  return true;
}

void tell(soci::session& sql, const DamagedRow& row, const std::string& reason) {
  const long long now =
      std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch()).count();
  const std::string none;
  const std::string checksum =
      row_checksum({row.message_id, row.topic, row.asset_id, none, std::to_string(now), reason});
  sql << "DELETE FROM quarantine WHERE message_id = :id", use(row.message_id, "id");
  sql << "INSERT INTO quarantine(message_id, topic, asset_id, pst_id, since, reason, state, asked_by, asked, checksum)"
         " VALUES(:id, :topic, :asset, '', :since, :reason, 'set_aside', '', 0, :checksum)",
      use(row.message_id, "id"), use(row.topic, "topic"), use(row.asset_id, "asset"), use(now, "since"),
      use(reason, "reason"), use(checksum, "checksum");
}

}  // namespace

void Journal::Database::mend() {
  check_small_tables();
  check_anchors();
  soci::transaction transaction(sql);
  const bool all = !meta(kToBeMended).empty();
  if (all) make_indexes_anew();
  if (all) forget_all_packed(sql);
  mend_positions();
  mend_quarantine();
  mend_inputs();
  mend_outputs(all);
  if (all) mark_missing_outputs();
  sql << std::string("DELETE FROM meta WHERE name = '") + kToBeMended + "'";
  transaction.commit();
  know_damaged_tests();
}

/// All but inputs and outputs, which are looked at little by little. Some are read when something happens that seldom
/// does: then it would be too late.
void Journal::Database::check_small_tables() {
  if (!is_file()) return;
  for (const std::string table : {"meta", "positions", "quarantine", "acts", "anchors", "alarms"}) {
    std::string answer;
    const std::string check = "PRAGMA integrity_check('" + table + "')";
    sql << check, into(answer);
    if (answer == "ok") continue;
    sql << "REINDEX " + table;
    sql << check, into(answer);
    if (answer != "ok") throw std::runtime_error("malformed: " + answer);
  }
  // Empty in most journals: no row of it is looked up.
  int some = 0;
  sql << "SELECT count(*) FROM (SELECT 1 FROM inputs INDEXED BY inputs_of_no_stream WHERE sequence = 0 LIMIT 1)",
      into(some);
}

/// Without them a record of acts that is cut looks whole. A journal of an earlier version has no sum.
void Journal::Database::check_anchors() {
  const std::string there = sum_of(anchors_in(sql));
  const std::string known = meta(kAnchorsSum);
  if (known == there) return;
  if (!known.empty())
    tell_of_journal(
        "what other services said of their records of acts was changed or removed, table anchors: compare "
        "their last hashes (sealwatch audit) with those that you noted");
  set_meta(kAnchorsSum, there);
}

// What an index left out may have been written again: then two rows have one id, and no index of them can be made. Such a
// file is made again as a whole.
void Journal::Database::make_indexes_anew() try {
  for (const std::string table : {"outputs", "inputs"}) sql << (is_file() ? "REINDEX " : "REINDEX TABLE ") + table;
} catch (const soci::soci_error& error) {
  if (std::string_view(error.what()).find("UNIQUE constraint failed") == std::string_view::npos) throw;
  throw std::runtime_error("malformed: a message stands in two rows");
}

void Journal::Database::mend_positions() {
  std::vector<StreamPosition> damaged;
  StreamPosition row;
  long long sequence = 0;
  std::string checksum;
  soci::statement statement =
      (sql.prepare << "SELECT topic, writer_id, sequence, checksum FROM positions WHERE checksum IS NOT NULL",
       into(row.topic), into(row.writer_id), into(sequence), into(checksum));
  statement.execute();
  while (statement.fetch())
    if (checksum != checksum_of_position(row.topic, row.writer_id, sequence)) damaged.push_back(row);
  for (const StreamPosition& one : damaged)
    sql << "DELETE FROM positions WHERE topic = :topic AND writer_id = :writer", use(one.topic, "topic"),
        use(one.writer_id, "writer");
  if (damaged.empty()) return;
  sql << "INSERT INTO positions(topic, writer_id, sequence) SELECT topic, writer_id, max(sequence) FROM inputs"
         " WHERE sequence > 0 GROUP BY topic, writer_id ON CONFLICT(topic, writer_id) DO NOTHING";
}

void Journal::Database::mend_quarantine() {
  std::vector<std::string> damaged;
  DamagedRow row;
  long long since = 0;
  std::string reason;
  std::string state;
  std::string checksum;
  soci::statement statement =
      (sql.prepare << "SELECT message_id, topic, asset_id, pst_id, since, reason, state, checksum FROM quarantine"
                      " WHERE checksum IS NOT NULL",
       into(row.message_id), into(row.topic), into(row.asset_id), into(row.pst_id), into(since), into(reason),
       into(state), into(checksum));
  statement.execute();
  while (statement.fetch()) {
    const bool is_state = state == "set_aside" || state == "retry" || state == "released";
    const std::string expected =
        row_checksum({row.message_id, row.topic, row.asset_id, row.pst_id, std::to_string(since), reason});
    if (!is_state || checksum != expected) damaged.push_back(row.message_id);
  }
  for (const std::string& id : damaged) sql << "DELETE FROM quarantine WHERE message_id = :id", use(id, "id");
  if (damaged.empty()) return;
  sql << "UPDATE inputs SET consumed = 0 WHERE consumed = 2 AND NOT EXISTS (SELECT 1 FROM quarantine q WHERE"
         " q.state <> 'released' AND (q.message_id = inputs.message_id OR (q.pst_id <> '' AND q.pst_id = inputs.pst_id"
         " AND q.asset_id = inputs.asset_id)))";
}

void Journal::Database::mend_inputs() {
  // A consumed input has no payload any more: one that has was not consumed.
  sql << "UPDATE inputs SET consumed = 0 WHERE payload IS NOT NULL AND consumed NOT IN (0, 2, 3, 4)";
  long long looked_at = 0;
  for (const DamagedRow& row : damaged_rows(sql, {}, steady_clock::time_point::max(), looked_at)) {
    if (put_checksum_right(sql, row, false)) continue;
    long long position = 0;
    sql << "SELECT coalesce(max(sequence), 0) FROM positions WHERE topic = :topic AND writer_id = :writer",
        use(row.topic, "topic"), use(row.writer_id, "writer"), into(position);
    if (is_of_a_service(row.topic) && row.sequence > 0 && row.sequence <= position) {
      sql << "DELETE FROM inputs WHERE receipt = :receipt", use(row.order, "receipt");
      fetch_again(row.topic, row.writer_id, row.sequence);
      continue;
    }
    sql << "DELETE FROM inputs WHERE receipt = :receipt", use(row.order, "receipt");  // or it would count as known
    tell(sql, row, "damaged in the journal; what came from outside cannot be fetched again: send it again");
  }
}

void Journal::Database::mend_outputs(bool all) {
  const auto end = all ? steady_clock::time_point::max() : steady_clock::now() + kLook;
  for (const DamagedRow& row : damaged_rows(sql, all ? "outputs" : kSomeOutputs, end, checked)) {
    if (put_checksum_right(sql, row, true) || put_right(sql, row)) continue;
    sql << "UPDATE outputs SET checksum = 'damaged' WHERE ordinal = :ordinal", use(row.order, "ordinal");
    forget_packed(sql, row.asset_id);
    tell(sql, row, "damaged in the journal; it is concluded again from the neighbours' messages, where they have them");
    std::vector<DamagedRow> sources;
    DamagedRow source;
    soci::statement statement =
        (sql.prepare << "SELECT receipt, topic, writer_id, sequence FROM inputs WHERE asset_id = :asset AND"
                        " pst_id = :pst AND pst_id <> '' AND consumed = 1 AND sequence > 0",
         use(row.asset_id, "asset"), use(row.pst_id, "pst"), into(source.order), into(source.topic),
         into(source.writer_id), into(source.sequence));
    statement.execute();
    while (statement.fetch())
      if (is_of_a_service(source.topic)) sources.push_back(source);
    for (const DamagedRow& one : sources) {
      sql << "DELETE FROM inputs WHERE receipt = :receipt", use(one.order, "receipt");
      fetch_again(one.topic, one.writer_id, one.sequence);
    }
  }
}

/// The numbers of conclusions, and those in each stream, have no gaps: what somebody removed leaves both, in the same
/// order, but for the last of a stream, which is taken for one of the stream before it. Readers count on over it; of what
/// it said nothing is known, and no test in which to conclude it again.
void Journal::Database::mark_missing_outputs() {
  std::vector<DamagedRow> missing;
  std::vector<std::pair<long long, DamagedRow>> places;  // with the row behind
  std::map<std::string, long long> sequences;
  DamagedRow row;
  long long expected = 1;
  soci::statement statement = (sql.prepare << "SELECT ordinal, topic, sequence, asset_id FROM outputs ORDER BY ordinal",
                               into(row.order), into(row.topic), into(row.sequence), into(row.asset_id));
  statement.execute();
  while (statement.fetch()) {
    for (; expected < row.order; ++expected) places.push_back({expected, row});
    expected = row.order + 1;
    for (long long& last = sequences[row.topic]; ++last < row.sequence;) {
      missing.push_back(row);
      missing.back().sequence = last;
    }
  }
  if (places.empty()) return;
  while (missing.size() < places.size()) {
    missing.push_back(places[missing.size()].second);
    missing.back().sequence = ++sequences[missing.back().topic];
  }
  for (std::size_t k = 0; k < places.size(); ++k) {
    const DamagedRow& one = missing[k];
    const std::string id = std::string(kDamagedMessage) + one.topic + "/" + std::to_string(one.sequence);
    sql << "INSERT INTO outputs(ordinal, topic, sequence, message_id, asset_id, pst_id, published, payload, checksum)"
           " VALUES(:ordinal, :topic, :sequence, :id, :asset, '', 0, '', 'damaged')",
        use(places[k].first, "ordinal"), use(one.topic, "topic"), use(one.sequence, "sequence"), use(id, "id"),
        use(one.asset_id, "asset");
  }
  tell_of_journal(std::to_string(places.size()) + " conclusions were removed from the journal, the first of them " +
                  missing.front().topic + " number " + std::to_string(missing.front().sequence) +
                  ": restore a backup, or retract and send again what they belong to");
}

void Journal::Database::know_damaged_tests() {
  damaged_tests.clear();
  std::pair<std::string, std::string> test;
  soci::statement statement =
      (sql.prepare << "SELECT asset_id, pst_id FROM outputs WHERE checksum = 'damaged' AND pst_id <> ''",
       into(test.first), into(test.second));
  statement.execute();
  while (statement.fetch()) damaged_tests.insert(test);
}

std::optional<Message> Journal::Database::fill_place(const Message& message, UtcTime publishing_time) {
  const Header& header = header_of(message);
  if (!damaged_tests.contains({asset_of(message), header.pst_id})) return std::nullopt;
  long long ordinal = 0;
  long long sequence = 0;
  sql << "SELECT ordinal, sequence FROM outputs WHERE message_id = :id AND checksum = 'damaged'",
      use(header.message_id, "id"), into(ordinal), into(sequence);
  if (!sql.got_data()) return std::nullopt;
  const std::string topic(name_of(topic_of(message)));
  const std::string asset = asset_of(message);
  const std::string payload = to_json(message, JsonForm::exact);
  const std::string checksum =
      checksum_of_output(ordinal, topic, sequence, header.message_id, asset, header.pst_id, payload);
  const long long published = publishing_time.nanoseconds;
  sql << "UPDATE outputs SET payload = :payload, checksum = :checksum, topic = :topic, asset_id = :asset, pst_id = "
         ":pst,"
         " published = :published WHERE ordinal = :ordinal",
      use(payload, "payload"), use(checksum, "checksum"), use(topic, "topic"), use(asset, "asset"),
      use(header.pst_id, "pst"), use(published, "published"), use(ordinal, "ordinal");
  sql << "UPDATE quarantine SET state = 'released' WHERE message_id = :id", use(header.message_id, "id");
  forget_packed(sql, asset);
  know_damaged_tests();
  Message placed = message;
  header_of(placed).writer_id = writer_id;
  header_of(placed).stream_sequence = static_cast<std::uint64_t>(sequence);
  header_of(placed).publishing_time_ns = published;
  return placed;
}

void Journal::Database::tell_of_journal(const std::string& reason) {
  DamagedRow row;
  row.message_id = "journal/" + service;
  tell(sql, row, reason);
}

/// Reads the stream again from there; what is known is passed over by its id.
void Journal::Database::fetch_again(const std::string& topic, const std::string& writer, long long sequence) {
  const long long before = sequence - 1;
  const std::string checksum = checksum_of_position(topic, writer, before);
  sql << "UPDATE positions SET sequence = :before, checksum = :checksum WHERE topic = :topic AND writer_id = :writer"
         " AND sequence > :limit",
      use(before, "before"), use(checksum, "checksum"), use(topic, "topic"), use(writer, "writer"),
      use(before, "limit");
}

}  // namespace sealwatch

// The tables of a journal: made, brought from an older version to this one, or refused.
#include <algorithm>
#include <array>
#include <charconv>
#include <random>

#include "services/common/store/audit_rows.hpp"
#include "services/common/store/database.hpp"
#include "services/common/store/row_checksum.hpp"
#include "services/common/text/format.hpp"

namespace sealwatch {
namespace {

using soci::into;
using soci::use;

/// Version 1. A new journal begins with it and goes through all that follows, so that there is one layout, not two.
constexpr std::array kVersion1 = {
    "CREATE TABLE meta(name VARCHAR(64) PRIMARY KEY, value TEXT NOT NULL)",
    "CREATE TABLE inputs(receipt BIGINT PRIMARY KEY, topic VARCHAR(64) NOT NULL, writer_id TEXT NOT NULL,"
    " sequence BIGINT NOT NULL, message_id TEXT NOT NULL UNIQUE, asset_id TEXT NOT NULL, pst_id TEXT NOT NULL,"
    " received BIGINT NOT NULL, consumed INTEGER NOT NULL, payload TEXT)",
    "CREATE INDEX inputs_open ON inputs(receipt) WHERE consumed = 0",
    "CREATE INDEX inputs_of_no_stream ON inputs(topic, asset_id, receipt) WHERE sequence = 0",
    "CREATE TABLE outputs(ordinal BIGINT PRIMARY KEY, topic VARCHAR(64) NOT NULL, sequence BIGINT NOT NULL,"
    " message_id TEXT NOT NULL UNIQUE, asset_id TEXT NOT NULL, pst_id TEXT NOT NULL, published BIGINT NOT NULL,"
    " payload TEXT NOT NULL, UNIQUE(topic, sequence))",
    "CREATE TABLE positions(topic VARCHAR(64) NOT NULL, writer_id TEXT NOT NULL, sequence BIGINT NOT NULL,"
    " PRIMARY KEY(topic, writer_id))",
};

/// What becomes of alarms (runtime/alarm_desk.hpp), of the service that keeps them.
constexpr const char* kAlarms =
    "CREATE TABLE IF NOT EXISTS alarms(kind VARCHAR(64) NOT NULL, asset_id VARCHAR(512) NOT NULL,"
    " subject VARCHAR(512) NOT NULL, payload TEXT NOT NULL, checksum VARCHAR(16) NOT NULL,"
    " PRIMARY KEY(kind, asset_id, subject))";

/// How far other services' records of acts went (audit_trail.hpp).
constexpr const char* kAnchors =
    "CREATE TABLE IF NOT EXISTS anchors(service VARCHAR(64) NOT NULL, sequence BIGINT NOT NULL,"
    " hash VARCHAR(64) NOT NULL, PRIMARY KEY(service, sequence, hash))";

/// What makes version n + 2 of version n + 1. Version 2: checksums of rows; those of older rows are not known. Version
/// 3: alarms. Version 4: indexes by which a start reads no more than it needs, however long the history; anchors. Version
/// 5: packed_outputs, which an older program would not keep to what it mends.
constexpr std::array<std::array<const char*, 5>, 4> kChanges = {{
    {"ALTER TABLE inputs ADD COLUMN checksum VARCHAR(16)", "ALTER TABLE outputs ADD COLUMN checksum VARCHAR(16)",
     "ALTER TABLE positions ADD COLUMN checksum VARCHAR(16)", "ALTER TABLE quarantine ADD COLUMN checksum VARCHAR(16)",
     "CREATE INDEX outputs_damaged ON outputs(asset_id, pst_id) WHERE checksum = 'damaged'"},
    {kAlarms},
    {"CREATE INDEX outputs_of_asset ON outputs(asset_id, ordinal, pst_id, topic)", "DROP INDEX inputs_open",
     "CREATE INDEX inputs_open ON inputs(asset_id, receipt) WHERE consumed = 0",
     "CREATE INDEX inputs_kept ON inputs(receipt) WHERE payload IS NOT NULL OR consumed <> 1", kAnchors},
    {kPackedOutputs},
}};
static_assert(kChanges.size() + 1 == kJournalSchemaVersion);

/// Later than version 1, and there before any change. "state" is set_aside, retry (asked for) or released.
constexpr const char* kQuarantine =
    "CREATE TABLE IF NOT EXISTS quarantine(message_id VARCHAR(512) PRIMARY KEY, topic VARCHAR(64) NOT NULL,"
    " asset_id TEXT NOT NULL, pst_id TEXT NOT NULL, since BIGINT NOT NULL, reason TEXT NOT NULL,"
    " state VARCHAR(16) NOT NULL, asked_by TEXT NOT NULL, asked BIGINT NOT NULL)";

/// "state_detection-9f86d081884c7d65": the service for people, 64 random bits for uniqueness.
std::string make_writer_id(const std::string& service) {
  std::random_device random;
  const std::uint64_t bits = static_cast<std::uint64_t>(random()) << 32U | random();
  return text::format("{}-{:016x}", service, bits);
}

int number_of(const std::string& text) {
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size() ? number : -1;
}

}  // namespace

std::string Journal::Database::meta(const std::string& key) {
  std::string value;
  sql << "SELECT value FROM meta WHERE name = :name", use(key, "name"), into(value);
  return value;
}

void Journal::Database::set_meta(const std::string& key, const std::string& value) {
  sql << "DELETE FROM meta WHERE name = :name", use(key, "name");
  sql << "INSERT INTO meta(name, value) VALUES(:name, :value)", use(key, "name"), use(value, "value");
}

void Journal::Database::create_schema() {
  soci::transaction transaction(sql);
  for (std::string statement : kVersion1) {
    // An INTEGER key, of any size, is SQLite's row number; any other is a second index to be written.
    const std::size_t key = statement.find("BIGINT PRIMARY KEY");
    if (is_file() && key != std::string::npos) statement.replace(key, 6, "INTEGER");
    sql << statement;
  }
  set_meta("schema_version", "1");
  set_meta("service", service);
  set_meta("writer_id", make_writer_id(service));
  set_meta(kNewJournal, "yes");
  transaction.commit();
  is_made = true;
}

/// Where the two disagree in a file, a bit was turned in one of them: a newer program writes both. The greater one is
/// right, or the tables of the step between are not there and are made (make_later_tables).
int Journal::Database::schema_version() {
  const int in_meta = number_of(meta("schema_version"));
  if (!is_file()) return in_meta;
  int in_header = 0;
  sql << "PRAGMA user_version", into(in_header);
  const auto is_known = [](int version) { return version >= 1 && version <= kJournalSchemaVersion; };
  if (!is_known(in_header)) return in_meta < 1 ? in_header : in_meta;  // version 1 left it alone
  return is_known(in_meta) ? std::max(in_meta, in_header) : in_header;
}

void Journal::Database::check_schema() {
  const int version = schema_version();
  if (version < 1 || version > kJournalSchemaVersion)
    throw Error{name, "table meta, schema_version", meta("schema_version"),
                "must be at most " + std::to_string(kJournalSchemaVersion) + ", the version that this program knows",
                "install the sealwatch that wrote this journal, or a newer one"};
  check_meta();
  has_all_tables = !is_made && version == kJournalSchemaVersion;
  if (version < kJournalSchemaVersion) migrate(version);
}

/// Where the checksum does not hold, the journal keeps its rows and goes on under a new name: to its readers it is one
/// that was made again.
void Journal::Database::check_meta() {
  writer_id = meta("writer_id");
  const std::string owner = meta("service");
  const std::string checksum = meta("checksum");
  if (checksum.empty() || checksum == checksum_of_meta(owner, writer_id)) {
    const bool is_another = lock && lock->last() && lock->last()->writer_id != writer_id;
    if (owner == service && (is_made || !is_another)) return;
    if (is_file()) throw OtherJournal{writer_id};
    throw Error{name, "table meta, service", owner, "must be '" + service + "': each service has a journal of its own",
                "give each service its own file or, in PostgreSQL, its own schema"};
  }
  soci::transaction transaction(sql);
  writer_id = make_writer_id(service);
  set_meta("service", service);
  set_meta("writer_id", writer_id);
  set_meta("checksum", checksum_of_meta(service, writer_id));
  transaction.commit();
}

/// All in one transaction: a program that is killed meanwhile leaves the journal as it was.
void Journal::Database::migrate(int version) {
  if (!has_table("quarantine")) sql << kQuarantine;
  soci::transaction transaction(sql);
  for (; version < kJournalSchemaVersion; ++version)
    for (const char* change : kChanges[static_cast<std::size_t>(version) - 1])
      if (change != nullptr) sql << change;
  set_meta("checksum", checksum_of_meta(service, writer_id));
  set_meta("schema_version", std::to_string(version));
  if (is_file()) sql << "PRAGMA user_version = " + std::to_string(version);
  transaction.commit();
}

/// Somebody may have dropped or renamed them: what stood in them is missing, and nobody else would tell.
void Journal::Database::make_later_tables() {
  std::string gone;
  const auto is_gone = [&](const char* table) {
    if (has_table(table)) return false;
    gone += (gone.empty() ? "" : ", ") + std::string(table);
    return true;
  };
  if (is_gone("quarantine")) {
    sql << kQuarantine;
    sql << "ALTER TABLE quarantine ADD COLUMN checksum VARCHAR(16)";
  }
  if (is_gone("alarms")) sql << kAlarms;
  if (is_gone("anchors")) sql << kAnchors;
  if (is_gone("acts")) make_acts_table(sql);
  if (!has_table("packed_outputs")) sql << kPackedOutputs;  // nothing is lost with it
  if (has_all_tables && !gone.empty())
    tell_of_journal("what the journal kept was removed from it, table " + gone +
                    ": restore a backup; sealwatch audit shows what is missing of acts");
}

}  // namespace sealwatch

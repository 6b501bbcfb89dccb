#include "services/common/store/database.hpp"

#include <array>
#include <cstdio>
#include <random>
#include <string_view>

#include "services/common/store/audit_rows.hpp"

namespace sealwatch {
namespace {

constexpr std::array kSchema = {
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

/// Beside the tables of version 1, which an older program goes on using without it: to that one an input that is set
/// aside is consumed. "state" is set_aside, retry (asked for) or released.
constexpr const char* kQuarantine =
    "CREATE TABLE IF NOT EXISTS quarantine(message_id VARCHAR(512) PRIMARY KEY, topic VARCHAR(64) NOT NULL,"
    " asset_id TEXT NOT NULL, pst_id TEXT NOT NULL, since BIGINT NOT NULL, reason TEXT NOT NULL,"
    " state VARCHAR(16) NOT NULL, asked_by TEXT NOT NULL, asked BIGINT NOT NULL)";

/// "state_detection-9f86d081884c7d65": the service for people, 64 random bits for uniqueness.
std::string make_writer_id(const std::string& service) {
  std::random_device random;
  const std::uint64_t bits = static_cast<std::uint64_t>(random()) << 32U | random();
  std::array<char, 17> text{};
  std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(bits));
  return service + "-" + text.data();
}

/// What to do about the database's complaint.
std::string advice_for(std::string_view what, bool is_server) {
  const auto says = [what](std::string_view words) { return what.find(words) != std::string_view::npos; };
  if (says("locked") || says("busy")) return "another process is writing to this journal: stop it, then start again";
  if (says("not a database") || says("malformed") || says("corrupt"))
    return "restore a backup, or move the file aside: the service then starts a new journal and asks its neighbours "
           "for their messages again";
  if (says("no schema")) return "create the schema named in search_path: CREATE SCHEMA name";
  if (is_server && (says("Cannot establish connection") || says("connection to server")))
    return "check that the server answers there and lets this user in: host, port, dbname, user; the password in "
           "~/.pgpass";
  if (says("connection string")) return "write sqlite3://FILE or postgresql://dbname=NAME";
  if (says("readonly") || says("read-only") || says("unable to open") || says("Cannot establish connection"))
    return "check that the directory exists and that this user may write to it";
  if (says("full")) return "free some space on the disk, then start again; nothing that was committed is lost";
  return {};
}

}  // namespace

std::string without_password(std::string connection) {
  const std::size_t begin = connection.find("password=");
  if (begin == std::string::npos) return connection;
  const std::size_t end = connection.find_first_of(" '\"", begin + 9);
  return connection.replace(begin + 9, end == std::string::npos ? end : end - begin - 9, "***");
}

Error Journal::Database::describe(const char* doing, const std::string& what) const {
  return {.file = name,
          .place = doing,
          .value = {},
          .rule = what,
          .advice = advice_for(what, name.starts_with("postgresql://"))};
}

void Journal::Database::open(const std::string& connection) {
  sql.open(connection);
  if (sql.get_backend_name() == "sqlite3") {
    std::string answer;
    if (connection.find("timeout=") == std::string::npos) sql << "PRAGMA busy_timeout = 5000", soci::into(answer);
    // Small pages, of a new file alone: a short batch touches some ten pages of the tables and their indexes, each of
    // which goes to the log whole. With 4096 bytes the disk has much more to write, and holds the writer up.
    sql << "PRAGMA page_size = 1024";
    sql << "PRAGMA journal_mode = WAL", soci::into(answer);
    sql << "PRAGMA synchronous = FULL";  // the schema, and the entry of the new log in its directory
    sql << "PRAGMA wal_autocheckpoint = 0", soci::into(answer);  // the checkpointer's work
    checkpointer.emplace(connection);
    file = file_of(connection);
  }
  if (!has_table("meta")) create_schema();
  check_schema();
  if (!has_table("quarantine")) sql << kQuarantine;
  make_acts_table(sql);
  load_counters();
  statements.emplace(sql);
}

/// The last few pages of a long log go into the file while nothing is written: then the next batch starts the log from
/// its beginning. SQLite is told at once that the batch will write: one that began by reading is refused, not made to
/// wait, if the log was started anew in between.
void Journal::Database::begin(Survives survives) {
  if (!checkpointer) {
    sql.begin();  // a server brings every batch to its disk
    return;
  }
  if (survives != synchronous && has_synced) {
    sql << (survives == Survives::power_cuts ? "PRAGMA synchronous = FULL" : "PRAGMA synchronous = NORMAL");
    synchronous = survives;
  }
  int ignored = 0;
  std::array<int, 2> pages{};
  if (checkpointer->nearly_done())
    sql << "PRAGMA wal_checkpoint(PASSIVE)", soci::into(ignored), soci::into(pages[0]), soci::into(pages[1]);
  sql << "BEGIN IMMEDIATE";
}

bool Journal::Database::has_table(const std::string& table) {
  int tables = 0;
  if (sql.get_backend_name() == "sqlite3")
    sql << "SELECT count(*) FROM sqlite_master WHERE name = :table", soci::use(table, "table"), soci::into(tables);
  else
    sql << "SELECT count(*) FROM pg_tables WHERE tablename = :table AND schemaname = current_schema()",
        soci::use(table, "table"), soci::into(tables);
  return tables != 0;
}

void Journal::Database::create_schema() {
  soci::transaction transaction(sql);
  for (std::string statement : kSchema) {
    // An INTEGER key, of any size, is SQLite's row number; any other is a second index to be written.
    const std::size_t key = statement.find("BIGINT PRIMARY KEY");
    if (checkpointer && key != std::string::npos) statement.replace(key, 6, "INTEGER");
    sql << statement;
  }
  const std::string version = std::to_string(kJournalSchemaVersion);
  const std::string writer = make_writer_id(service);
  const std::string insert = "INSERT INTO meta(name, value) VALUES(:name, :value)";
  // Named, as SOCI keeps references until the statement runs: at the end of the line, after temporaries are gone.
  const std::array<std::pair<std::string, std::string>, 3> rows = {
      {{"schema_version", version}, {"service", service}, {"writer_id", writer}}};
  for (const auto& [key, value] : rows) sql << insert, soci::use(key, "name"), soci::use(value, "value");
  transaction.commit();
}

void Journal::Database::check_schema() {
  const auto meta = [this](const std::string& key) {
    std::string value;
    sql << "SELECT value FROM meta WHERE name = :name", soci::use(key, "name"), soci::into(value);
    return value;
  };
  const auto refuse = [this](const char* place, std::string value, std::string rule, std::string advice) {
    throw Error{name, place, std::move(value), std::move(rule), std::move(advice)};
  };
  const std::string version = meta("schema_version");
  const std::string owner = meta("service");
  if (version != std::to_string(kJournalSchemaVersion))
    refuse("table meta, schema_version", version,
           "must be " + std::to_string(kJournalSchemaVersion) + ", the version that this program knows",
           "install the sealwatch that wrote this journal, or a newer one");
  if (owner != service)
    refuse("table meta, service", owner, "must be '" + service + "': each service has a journal of its own",
           "give each service its own file or, in PostgreSQL, its own schema");
  writer_id = meta("writer_id");
}

void Journal::Database::load_counters() {
  sql << "SELECT coalesce(max(receipt), 0) FROM inputs", soci::into(last_receipt);
  sql << "SELECT coalesce(max(ordinal), 0) FROM outputs", soci::into(last_ordinal);
  long long open = 0;
  sql << "SELECT count(*) FROM inputs WHERE consumed = 0", soci::into(open);
  open_inputs = static_cast<std::uint64_t>(open);
  written.clear();
  std::string topic;
  long long last = 0;
  soci::statement streams =
      (sql.prepare << "SELECT topic, max(sequence) FROM outputs GROUP BY topic", soci::into(topic), soci::into(last));
  streams.execute();
  while (streams.fetch())
    if (const auto known = value_of<Topic>(topic)) written[*known] = static_cast<std::uint64_t>(last);
}

Result<Journal> Journal::open(const std::string& connection, const std::string& service) {
  if (const Status known = check_kind(connection); !known) return fail(known.error());
  auto database = std::make_unique<Database>();
  database->name = without_password(connection);
  database->service = service;
  const Status opened = database->guard("opening the journal", [&] { database->open(connection); });
  if (!opened) return fail(opened.error());
  return Journal(std::move(database));
}

}  // namespace sealwatch

#include "services/common/store/database.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <stdexcept>
#include <string_view>

#include "services/common/store/connection_string.hpp"
#include "services/common/store/damaged_file.hpp"
#include "services/common/store/log_sync.hpp"

namespace sealwatch {
namespace {

/// What is written since, only the neighbours miss in an older copy.
constexpr std::chrono::minutes kRemembers{1};

/// What to do about the database's complaint.
std::string advice_for(std::string_view what, bool is_server) {
  what = what.substr(0, what.find(" while "));  // what follows are the row's values: people's words
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

Error Journal::Database::describe(const char* doing, const std::string& what) const {
  if (!file.empty() && is_damage(file, what)) note_damage(file);
  return {.file = name,
          .place = doing,
          .value = {},
          .rule = what,
          .advice = advice_for(what, name.starts_with("postgresql://"))};
}

void Journal::Database::take_file(const std::string& path) {
  file = path;
  auto taken = JournalLock::take(path);
  if (!taken) throw taken.error();
  lock.emplace(std::move(*taken));
}

void Journal::Database::connect(const std::string& connection) {
  open_session(sql, connection);
  if (!is_file()) {
    if (const auto taken = lock_schema(sql, name)) throw *taken;
    return;
  }
  std::string answer;
  if (connection.find("timeout=") == std::string::npos) sql << "PRAGMA busy_timeout = 5000", soci::into(answer);
  // Small pages, of a new file alone: a short batch touches some ten pages of the tables and their indexes, each of
  // which goes to the log whole. With 4096 bytes the disk has much more to write, and holds the writer up.
  sql << "PRAGMA page_size = 1024";
  sql << "PRAGMA journal_mode = WAL", soci::into(answer);
  sql << "PRAGMA synchronous = FULL";  // the schema, and the entry of the new log in its directory
  sql << "PRAGMA wal_autocheckpoint = 0", soci::into(answer);  // the checkpointer's work
  checkpointer.emplace(connection);
}

void Journal::Database::make_ready() {
  if (!has_table("meta") && has_table("outputs")) throw std::runtime_error("malformed: table meta is not there");
  if (!has_table("meta")) create_schema();
  check_schema();
  make_later_tables();
  mend();
  load_counters();
}

std::string Journal::Database::make_anew(const std::string& connection) {
  checkpointer.reset();
  sql.close();
  std::string aside = move_aside(file);
  connect(connection);
  make_ready();
  return aside;
}

/// A file in which SQLite cannot find its way, or that is another's or may not be read, is moved aside, and the journal
/// made again: the neighbours have their messages, and of the old file is kept what can be read of what people did.
void Journal::Database::open(const std::string& connection) {
  if (connection.starts_with("sqlite3://")) take_file(file_of(connection));
  const auto opened_up = file.empty() ? std::nullopt : make_accessible(file);
  try {
    if (!file.empty() && is_known_damaged(file)) throw std::runtime_error("malformed when it was last used");
    connect(connection);
    make_ready();
    if (opened_up) tell_of_journal(*opened_up);
    if (!opened_up || !is_made) compare_with_last();
  } catch (const OtherJournal& other) {
    const std::string aside = make_anew(connection);
    tell_of_journal("the journal of " + other.writer_id + " was in the place of this service's and is now " + aside +
                    "; this service's is made again from the neighbours' messages: restore a backup of its own");
  } catch (const std::exception& exception) {
    if (file.empty() || !is_damage(file, exception.what())) throw;
    const std::string aside = make_anew(connection);
    keep_acts_of(aside, sql);
    tell_of_journal(
        "the journal was damaged and is made again from the neighbours' messages, with what people said; the old one "
        "is " +
        aside + ": see that sealwatch audit shows the acts in force, and acknowledge and shelve alarms again");
  }
  statements.emplace(sql);
  check_in_place();
  note_last_used();
  committed = last_ordinal;
  remember();
}

void Journal::Database::compare_with_last() {
  if (!lock || !lock->last()) return;
  const long long ended = lock->last()->conclusions;
  if (is_made)
    tell_of_journal(
        "the journal, or its write-ahead log, was removed; it is made again from the neighbours' messages, as far as "
        "they have theirs: restore a backup for the rest");
  else if (last_ordinal < ended)
    tell_of_journal("the journal ends at conclusion " + std::to_string(last_ordinal) + " and went to " +
                    std::to_string(ended) +
                    ": it is an older copy, or its end was cut off; what is missing is made again from the "
                    "neighbours' messages");
}

void Journal::Database::note_last_used() {
  for (const char* last : {"SELECT received FROM inputs WHERE receipt = (SELECT max(receipt) FROM inputs)",
                           "SELECT published FROM outputs WHERE ordinal = (SELECT max(ordinal) FROM outputs)"}) {
    long long at = 0;
    sql << last, soci::into(at);
    last_used_ns = std::max(last_used_ns, at);
  }
  if (lock && lock->last()) last_used_ns = std::max(last_used_ns, lock->last()->at_ns);
}

void Journal::Database::remember() {
  if (!lock || !statements || !LogSync(file + "-wal").sync()) return;
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  remembered = std::chrono::steady_clock::now();
  lock->remember({writer_id, committed, std::chrono::duration_cast<std::chrono::nanoseconds>(now).count()});
}

void Journal::Database::remember_now_and_then() {
  if (!lock || !lock->last() || lock->last()->conclusions == committed) return;
  if (std::chrono::steady_clock::now() - remembered >= kRemembers) remember();
}

/// SQLite goes on with files that were removed, or that others took the place of: all that is written, and confirmed, is
/// gone when the process ends. It is noticed while little is lost; what follows is that of a lost journal.
void Journal::Database::check_in_place() {
  if (file.empty()) return;
  for (const std::string& path : {file, file + "-wal"}) {
    struct stat now {};
    const bool is_there = ::stat(path.c_str(), &now) == 0;
    const auto opened = opened_files.find(path);
    if (opened == opened_files.end()) {
      if (is_there) opened_files.emplace(path, std::pair(now.st_dev, now.st_ino));
    } else if (!is_there || opened->second != std::pair(now.st_dev, now.st_ino)) {
      throw Error{.file = name,
                  .place = path,
                  .value = {},
                  .rule = "was removed or replaced while this service ran: what it wrote since is lost",
                  .advice = "leave the files of a running service alone; restore a backup while it is stopped"};
    }
  }
}

/// The last few pages of a long log go into the file while nothing is written: then the next batch starts the log from
/// its beginning. SQLite is told at once that the batch will write: one that began by reading is refused, not made to
/// wait, if the log was started anew in between.
void Journal::Database::begin(Survives survives) {
  if (lock && !lock->holds())
    throw Error{.file = name,
                .place = file + ".lock",
                .value = {},
                .rule = "was removed while this service ran: another may have this journal now",
                .advice = "stop all but one of them, and leave the lock alone"};
  check_in_place();
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

void Journal::Database::load_counters() {
  sql << "SELECT coalesce(max(receipt), 0) FROM inputs", soci::into(last_receipt);
  sql << "SELECT coalesce(max(ordinal), 0) FROM outputs", soci::into(last_ordinal);
  long long open = 0;
  sql << "SELECT count(*) FROM inputs WHERE consumed = 0", soci::into(open);
  open_inputs = static_cast<std::uint64_t>(open);
  written.clear();
  for (const std::string_view known : EnumNames<Topic>::kNames) {  // each from its index: a GROUP BY would read it all
    const std::string topic(known);
    long long last = 0;
    sql << "SELECT coalesce(max(sequence), 0) FROM outputs WHERE topic = :topic", soci::use(topic, "topic"),
        soci::into(last);
    if (last > 0) written[*value_of<Topic>(topic)] = static_cast<std::uint64_t>(last);
  }
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

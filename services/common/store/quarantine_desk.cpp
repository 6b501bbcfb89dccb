#include "services/common/store/quarantine_desk.hpp"

#include <soci/soci.h>

#include <filesystem>
#include <utility>

#include "services/common/store/audit_rows.hpp"
#include "services/common/store/connection_string.hpp"
#include "services/common/store/journal_reader.hpp"

namespace sealwatch {

using soci::into;
using soci::use;

namespace {

/// SQLite is told at once that it will write: one that began by reading may be refused (database.cpp).
class Transaction {
 public:
  explicit Transaction(soci::session& sql) : sql_(sql) {
    if (sql_.get_backend_name() == "sqlite3")
      sql_ << "BEGIN IMMEDIATE";
    else
      sql_.begin();
  }
  ~Transaction() {
    if (!open_) return;
    try {
      sql_ << "ROLLBACK";
    } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): the reason is being told already
    }
  }
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  void commit() {
    sql_ << "COMMIT";
    open_ = false;
  }

 private:
  soci::session& sql_;
  bool open_ = true;
};

}  // namespace

struct QuarantineDesk::Session {
  std::string place;
  std::string service;
  soci::session sql;
  bool has_table = false;  ///< a journal of an older program has none, until its service runs again

  template <class Work>
  [[nodiscard]] auto guard(Work&& work) -> Result<decltype(work())> {
    try {
      return work();
    } catch (const std::exception& exception) {
      return fail(Error{.file = place,
                        .place = "quarantine",
                        .value = {},
                        .rule = exception.what(),
                        .advice = "ask as a user that may write there: the service's own, or root"});
    }
  }

  void look_for_table() {
    int tables = 0;
    if (sql.get_backend_name() == "sqlite3")
      sql << "SELECT count(*) FROM sqlite_master WHERE name = 'quarantine'", into(tables);
    else
      sql << "SELECT count(*) FROM pg_tables WHERE tablename = 'quarantine' AND schemaname = current_schema()",
          into(tables);
    has_table = tables != 0;
  }
};

QuarantineDesk::QuarantineDesk(std::unique_ptr<Session> session) : session_(std::move(session)) {}
QuarantineDesk::~QuarantineDesk() = default;
QuarantineDesk::QuarantineDesk(QuarantineDesk&& other) noexcept = default;
QuarantineDesk& QuarantineDesk::operator=(QuarantineDesk&& other) noexcept = default;

Result<QuarantineDesk> QuarantineDesk::open(const std::string& connection, const std::string& service) {
  // It says what is wrong with a journal that is none, or another's, or of a newer program.
  if (const auto readable = JournalReader::open(connection, service); !readable) return fail(readable.error());
  auto session = std::make_unique<Session>();
  session->place = without_password(connection);
  session->service = service;
  const auto opened = session->guard([&] {
    open_session(session->sql, connection);
    std::string answer;
    if (session->sql.get_backend_name() == "sqlite3") session->sql << "PRAGMA busy_timeout = 5000", into(answer);
    session->look_for_table();
    return true;
  });
  if (!opened) return fail(opened.error());
  return QuarantineDesk(std::move(session));
}

Result<std::vector<QuarantineDesk::Entry>> QuarantineDesk::list() {
  return session_->guard([&] {
    std::vector<Entry> entries;
    if (!session_->has_table) return entries;
    Entry row;
    long long since = 0;
    long long asked = 0;
    soci::statement statement =
        (session_->sql.prepare << "SELECT message_id, topic, asset_id, pst_id, since, reason, state, asked_by, asked"
                                  " FROM quarantine ORDER BY since, message_id",
         into(row.message.message_id), into(row.message.topic), into(row.message.asset_id), into(row.message.pst_id),
         into(since), into(row.message.reason), into(row.state), into(row.asked_by), into(asked));
    statement.execute();
    while (statement.fetch()) {
      row.message.since_ns = since;
      row.asked_ns = asked;
      entries.push_back(row);
    }
    return entries;
  });
}

Result<bool> QuarantineDesk::ask_again(const std::string& message_id, const std::string& who, UtcTime now) {
  return session_->guard([&] {
    if (!session_->has_table) return false;
    make_acts_table(session_->sql);
    const long long asked = now.nanoseconds;
    Transaction transaction(session_->sql);
    soci::statement statement = (session_->sql.prepare << "UPDATE quarantine SET state = 'retry', asked_by = :who,"
                                                          " asked = :asked WHERE message_id = :id AND"
                                                          " state <> 'released'",
                                 use(who, "who"), use(asked, "asked"), use(message_id, "id"));
    statement.execute(true);
    const bool is_set_aside = statement.get_affected_rows() > 0;
    std::string asset_id;
    session_->sql << "SELECT asset_id FROM quarantine WHERE message_id = :id", use(message_id, "id"), into(asset_id);
    if (is_set_aside)
      append_act(session_->sql, session_->service,
                 {.at = now,
                  .kind = "quarantine_retry",
                  .asset_id = asset_id,
                  .who = who,
                  .subject = message_id,
                  .text = {},
                  .outcome = "taken"});
    transaction.commit();
    return is_set_aside;
  });
}

}  // namespace sealwatch

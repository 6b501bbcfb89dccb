#include "services/common/store/audit_trail.hpp"

#include <openssl/evp.h>

#include <array>
#include <sstream>
#include <stdexcept>

#include "services/common/store/audit_rows.hpp"
#include "services/common/store/connection_string.hpp"
#include "services/common/store/database.hpp"
#include "services/common/store/journal_reader.hpp"
#include "services/common/store/row_checksum.hpp"

namespace sealwatch {
namespace {

using soci::into;
using soci::use;

std::string sha256(const std::string& bytes) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  if (EVP_Digest(bytes.data(), bytes.size(), digest.data(), &size, EVP_sha256(), nullptr) != 1)
    throw std::runtime_error("SHA-256 is not available");
  constexpr const char* kDigits = "0123456789abcdef";
  std::string text;
  for (unsigned int k = 0; k < size; ++k) text.append({kDigits[digest[k] >> 4U], kDigits[digest[k] & 15U]});
  return text;
}

/// With its length before it: nothing moves from one field to the next unseen.
void add(std::string& bytes, const std::string& field) {
  bytes.append(std::to_string(field.size())).append(":").append(field);
}

bool is_file(soci::session& sql) { return sql.get_backend_name() == "sqlite3"; }

bool has_table(soci::session& sql, const std::string& table) {
  int tables = 0;
  if (is_file(sql))
    sql << "SELECT count(*) FROM sqlite_master WHERE name = :table", use(table, "table"), into(tables);
  else
    sql << "SELECT count(*) FROM pg_tables WHERE tablename = :table AND schemaname = current_schema()",
        use(table, "table"), into(tables);
  return tables != 0;
}

/// What `read` finds in a service's journal, which is not changed.
template <class Read>
auto look_into(const std::string& connection, const std::string& service, const std::string& table, Read&& read)
    -> Result<decltype(read(std::declval<soci::session&>()))> {
  // It says what is wrong with a journal that is none, or another's, or of a newer program.
  if (const auto readable = JournalReader::open(connection, service); !readable) return fail(readable.error());
  try {
    soci::session sql;
    open_session(sql, connection);
    std::string answer;
    if (is_file(sql)) sql << "PRAGMA busy_timeout = 5000", into(answer);
    return read(sql);
  } catch (const std::exception& exception) {
    return fail(Error{.file = without_password(connection),
                      .place = "table " + table,
                      .value = {},
                      .rule = exception.what(),
                      .advice = "look as a user that may read there: the service's own, or root"});
  }
}

AuditBreak broken(std::int64_t sequence, std::string why) { return {sequence, std::move(why)}; }

}  // namespace

std::string audit_begin(const std::string& service) { return sha256("sealwatch.audit/1 " + service); }

std::string audit_hash(const AuditEntry& entry) {
  const OperatorAct& act = entry.act;
  std::string bytes;
  for (const std::string& field : {entry.previous, std::to_string(entry.sequence), std::to_string(act.at.nanoseconds),
                                   act.kind, act.asset_id, act.who, act.subject, act.text, act.outcome})
    add(bytes, field);
  return sha256(bytes);
}

std::optional<AuditBreak> find_break(const std::string& service, const std::vector<AuditEntry>& entries) {
  std::string previous = audit_begin(service);
  std::int64_t expected = 1;
  for (const AuditEntry& entry : entries) {
    if (entry.sequence != expected)
      return broken(
          expected,
          std::string("entry ").append(std::to_string(entry.sequence)).append(" is in its place: it was removed"));
    if (entry.previous != previous) return broken(expected, "it does not follow on the entry before it");
    if (entry.hash != audit_hash(entry)) return broken(expected, "it is not what was written");
    previous = entry.hash;
    ++expected;
  }
  return std::nullopt;
}

void make_acts_table(soci::session& sql) {
  if (has_table(sql, "acts")) return;
  const std::string key = is_file(sql) ? "INTEGER" : "BIGINT";
  sql << "CREATE TABLE IF NOT EXISTS acts(sequence " + key +
             " PRIMARY KEY, at BIGINT NOT NULL, kind TEXT NOT NULL, asset_id TEXT NOT NULL, who TEXT NOT NULL,"
             " subject TEXT NOT NULL, remark TEXT NOT NULL, outcome TEXT NOT NULL, previous VARCHAR(64) NOT NULL,"
             " hash VARCHAR(64) NOT NULL)";
  if (!is_file(sql)) return;
  for (const char* change : {"UPDATE", "DELETE"})
    sql << "CREATE TRIGGER IF NOT EXISTS acts_no_" << change << " BEFORE " << change
        << " ON acts BEGIN SELECT RAISE(ABORT, 'acts are only added'); END";
}

AuditEntry append_act(soci::session& sql, const std::string& service, const OperatorAct& act) {
  if (!is_file(sql)) sql << "LOCK TABLE acts IN EXCLUSIVE MODE";  // services and those who ask write side by side
  AuditEntry entry{.sequence = 0, .act = act, .previous = audit_begin(service), .hash = {}};
  long long last = 0;
  sql << "SELECT coalesce(max(sequence), 0) FROM acts", into(last);
  if (last > 0) sql << "SELECT hash FROM acts WHERE sequence = :last", use(last, "last"), into(entry.previous);
  const long long sequence = last + 1;
  entry.sequence = sequence;
  entry.hash = audit_hash(entry);
  const long long at = act.at.nanoseconds;
  sql << "INSERT INTO acts(sequence, at, kind, asset_id, who, subject, remark, outcome, previous, hash)"
         " VALUES(:sequence, :at, :kind, :asset, :who, :subject, :remark, :outcome, :previous, :hash)",
      use(sequence, "sequence"), use(at, "at"), use(act.kind, "kind"), use(act.asset_id, "asset"), use(act.who, "who"),
      use(act.subject, "subject"), use(act.text, "remark"), use(act.outcome, "outcome"),
      use(entry.previous, "previous"), use(entry.hash, "hash");
  return entry;
}

std::vector<AuditEntry> acts_in(soci::session& sql) {
  std::vector<AuditEntry> entries;
  if (!has_table(sql, "acts")) return entries;
  AuditEntry row;
  long long sequence = 0;
  long long at = 0;
  soci::statement statement =
      (sql.prepare << "SELECT sequence, at, kind, asset_id, who, subject, remark, outcome, previous, hash FROM acts"
                      " ORDER BY sequence",
       into(sequence), into(at), into(row.act.kind), into(row.act.asset_id), into(row.act.who), into(row.act.subject),
       into(row.act.text), into(row.act.outcome), into(row.previous), into(row.hash));
  statement.execute();
  while (statement.fetch()) {
    row.sequence = sequence;
    row.act.at = UtcTime{at};
    entries.push_back(row);
  }
  return entries;
}

Result<std::vector<AuditEntry>> read_audit_trail(const std::string& connection, const std::string& service) {
  return look_into(connection, service, "acts", [](soci::session& sql) { return acts_in(sql); });
}

std::optional<AuditBreak> find_cut(const std::string& service, const std::vector<AuditEntry>& entries,
                                   const std::vector<AuditAnchor>& heard) {
  std::optional<AuditBreak> first;
  for (const AuditAnchor& anchor : heard) {
    if (anchor.service != service || anchor.sequence < 1 || (first && first->sequence <= anchor.sequence)) continue;
    const auto place = static_cast<std::size_t>(anchor.sequence) - 1;
    if (place >= entries.size())
      first = broken(anchor.sequence,
                     "other services have heard of it, and it is not there: the end was cut off, or the "
                     "journal is an older copy");
    else if (entries[place].hash != anchor.hash)
      first =
          broken(anchor.sequence, "other services have heard of another entry in its place, with hash " + anchor.hash);
  }
  return first;
}

std::vector<AuditAnchor> anchors_in(soci::session& sql) {
  std::vector<AuditAnchor> anchors;
  if (!has_table(sql, "anchors")) return anchors;
  AuditAnchor row;
  long long sequence = 0;
  soci::statement statement = (sql.prepare << "SELECT service, sequence, hash FROM anchors ORDER BY service, sequence",
                               into(row.service), into(sequence), into(row.hash));
  statement.execute();
  while (statement.fetch()) {
    row.sequence = sequence;
    anchors.push_back(row);
  }
  return anchors;
}

bool add_anchor(soci::session& sql, const AuditAnchor& heard) {
  const long long sequence = heard.sequence;
  soci::statement insert =
      (sql.prepare << "INSERT INTO anchors(service, sequence, hash) VALUES(:service, :sequence, :hash)"
                      " ON CONFLICT(service, sequence, hash) DO NOTHING",
       use(heard.service, "service"), use(sequence, "sequence"), use(heard.hash, "hash"));
  insert.execute(true);
  return insert.get_affected_rows() > 0;
}

std::string with_anchor(const std::string& sum, const AuditAnchor& added) {
  std::uint64_t number = 0, total = 0;
  std::istringstream(sum) >> number >> total;
  total += checksum_of_anchor(added.service, added.sequence, added.hash);
  return std::to_string(number + 1) + " " + std::to_string(total);
}

std::string sum_of(const std::vector<AuditAnchor>& anchors) {
  std::string sum = "0 0";
  for (const AuditAnchor& one : anchors) sum = with_anchor(sum, one);
  return sum;
}

Result<AuditAnchors> read_audit_anchors(const std::string& connection, const std::string& service) {
  return look_into(connection, service, "anchors", [](soci::session& sql) {
    const soci::transaction one_moment(sql);  // a running service writes both
    AuditAnchors found{.heard = anchors_in(sql)};
    std::string sum;
    sql << std::string("SELECT value FROM meta WHERE name = '") + kAnchorsSum + "'", into(sum);
    found.are_whole = sum.empty() || sum == sum_of(found.heard);
    return found;
  });
}

}  // namespace sealwatch

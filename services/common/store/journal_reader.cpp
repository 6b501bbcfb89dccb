#include "services/common/store/journal_reader.hpp"

#include <soci/soci.h>

#include <filesystem>
#include <utility>

#include "services/common/store/connection_string.hpp"
#include "services/common/store/database.hpp"
#include "services/common/store/journal.hpp"
#include "services/common/store/row_checksum.hpp"
#include "services/common/store/rows.hpp"

namespace sealwatch {
namespace {

using soci::into;
using soci::use;

constexpr std::string_view kFile = "sqlite3://";

std::string topic_name(Topic topic) { return std::string(name_of(topic)); }

/// What SQLite says of a file that is none of its own, or not whole any more; "" where that is not its complaint.
std::string damage_in(std::string_view complaint) {
  for (const char* words :
       {"file is not a database", "database disk image is malformed", "file is encrypted", "no such table"})
    if (complaint.find(words) != std::string_view::npos) return words;
  return {};
}

}  // namespace

struct JournalReader::Session {
  std::string place;
  std::string writer_id;
  std::string whole;            ///< condition: rows that were not found damaged
  std::string checksum = "''";  ///< column
  soci::session sql;

  /// Runs `work`, turning the library's exceptions into an Error that names the journal.
  template <class Work>
  [[nodiscard]] auto guard(Work&& work) -> Result<decltype(work())> {
    try {
      return work();
    } catch (const Error& error) {
      return fail(error);
    } catch (const std::exception& exception) {
      if (const std::string damage = damage_in(exception.what()); !damage.empty())
        return fail(Error{.file = place,
                          .place = {},
                          .value = {},
                          .rule = "the journal is damaged (" + damage + ")",
                          .advice = "restore it from a backup, or move it aside: its service then starts with an empty "
                                    "one"});
      return fail(Error{.file = place,
                        .place = "looking into the journal",
                        .value = {},
                        .rule = exception.what(),
                        .advice = "look as a user that may read and write there: the service's own, or root"});
    }
  }

  /// Outputs of a topic and an asset, or of a message id, in the order of conclusion. Throws Error where one is not as
  /// it was written.
  [[nodiscard]] std::vector<Message> outputs(const std::string& condition, const std::string& first,
                                             const std::string& second) {
    MessageRow row;
    soci::statement query =
        (sql.prepare << "SELECT ordinal, topic, payload, sequence, message_id, asset_id, pst_id, " + checksum +
                            " FROM outputs WHERE " + condition + whole + " ORDER BY ordinal",
         use(first, "first"), use(second, "second"), into(row.order), into(row.topic), into(row.payload),
         into(row.sequence), into(row.message_id), into(row.asset_id), into(row.pst_id), into(row.checksum));
    std::vector<Message> messages;
    query.execute();
    while (query.fetch()) {
      check(row);
      messages.push_back(message_of(row, place));
    }
    return messages;
  }

  void check(const MessageRow& row) const {
    if (is_as_written(row)) return;
    throw Error{.file = place,
                .place = "output " + std::to_string(row.order),
                .value = row.message_id,
                .rule = "is not as it was written: a disk or a memory turned a bit",
                .advice = "start its service, which makes it anew from the neighbours' messages, or restore a backup"};
  }

  [[nodiscard]] std::string meta(const std::string& name) {
    std::string value;
    sql << "SELECT value FROM meta WHERE name = :name", use(name, "name"), into(value);
    return value;
  }

  /// Throws Error where this is not the service's journal, or one of a newer program.
  void check(const std::string& service) {
    const std::string version = meta("schema_version");
    const bool known = version.size() == 1 && version[0] >= '1' && version[0] - '0' <= kJournalSchemaVersion;
    if (!known)
      throw Error{place, "table meta, schema_version", version,
                  "must be at most " + std::to_string(kJournalSchemaVersion) + ", the version that this program knows",
                  "look with the sealwatch that wrote this journal, or a newer one"};
    const std::string owner = meta("service");
    if (owner != service) throw Error{place, "table meta, service", owner, "must be '" + service + "'", {}};
    writer_id = meta("writer_id");
    if (version[0] < '2') return;
    checksum = "coalesce(checksum, '')";
    whole = " AND " + checksum + " <> 'damaged'";
  }
};

JournalReader::JournalReader(std::unique_ptr<Session> session) : session_(std::move(session)) {}
JournalReader::~JournalReader() = default;
JournalReader::JournalReader(JournalReader&& other) noexcept = default;
JournalReader& JournalReader::operator=(JournalReader&& other) noexcept = default;

Result<JournalReader> JournalReader::open(const std::string& connection, const std::string& service) {
  if (const Status known = Journal::check_kind(connection); !known) return fail(known.error());
  auto session = std::make_unique<Session>();
  session->place = without_password(connection);
  std::string to_open = connection;
  if (connection.starts_with(kFile)) {
    const std::string file = Journal::file_of(connection);
    std::error_code none;
    if (!std::filesystem::is_regular_file(file, none)) {
      const bool is_other = std::filesystem::exists(file, none);
      const char* const rule = is_other ? "is not a file: no journal of a service" : "does not exist";
      return fail(Error{.file = file, .place = {}, .value = {}, .rule = rule, .advice = {}});
    }
    to_open = std::string(kFile).append("dbname=\"").append(file).append("\" readonly=true timeout=5");
  }
  const auto opened = session->guard([&] {
    open_session(session->sql, to_open);
    session->check(service);
    return true;
  });
  if (!opened) return fail(opened.error());
  return JournalReader(std::move(session));
}

const std::string& JournalReader::place() const { return session_->place; }

const std::string& JournalReader::writer_id() const { return session_->writer_id; }

Result<std::optional<Message>> JournalReader::output(const std::string& message_id) {
  return session_->guard([&]() -> std::optional<Message> {
    std::vector<Message> found = session_->outputs("message_id = :first AND :second = ''", message_id, "");
    return found.empty() ? std::nullopt : std::optional(std::move(found.front()));
  });
}

Result<std::vector<Message>> JournalReader::outputs(Topic topic, const std::string& asset_id) {
  return session_->guard(
      [&] { return session_->outputs("topic = :first AND asset_id = :second", topic_name(topic), asset_id); });
}

Result<std::vector<std::string>> JournalReader::output_ids(Topic topic, const std::string& asset_id) {
  return session_->guard([&] {
    const std::string name = topic_name(topic);
    std::string id;
    std::string asset;
    soci::statement query = (session_->sql.prepare << "SELECT message_id, asset_id FROM outputs WHERE topic = :topic" +
                                                          session_->whole + " ORDER BY ordinal",
                             use(name, "topic"), into(id), into(asset));
    std::vector<std::string> ids;
    query.execute();
    while (query.fetch())
      if (asset_id.empty() || asset == asset_id) ids.push_back(id);
    return ids;
  });
}

Result<std::vector<std::string>> JournalReader::assets(Topic topic) {
  return session_->guard([&] {
    const std::string name = topic_name(topic);
    std::string asset;
    soci::statement query =
        (session_->sql.prepare << "SELECT DISTINCT asset_id FROM outputs WHERE topic = :topic ORDER BY asset_id",
         use(name, "topic"), into(asset));
    std::vector<std::string> assets;
    query.execute();
    while (query.fetch()) assets.push_back(asset);
    return assets;
  });
}

Result<bool> JournalReader::has_input(const std::string& message_id) {
  return session_->guard([&] {
    int count = 0;
    session_->sql << "SELECT count(*) FROM inputs WHERE message_id = :id", use(message_id, "id"), into(count);
    return count > 0;
  });
}

}  // namespace sealwatch

#include "services/common/store/journal_reader.hpp"

#include <soci/soci.h>

#include <filesystem>
#include <utility>

#include "services/common/message/json.hpp"
#include "services/common/store/connection_string.hpp"
#include "services/common/store/database.hpp"
#include "services/common/store/journal.hpp"

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
  std::string whole;  ///< condition: rows that are as they were written
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

  [[nodiscard]] Message message_of(const std::string& topic, const std::string& payload) const {
    const auto known = value_of<Topic>(topic);
    Result<Message> message =
        known ? message_from_json(*known, payload)
              : fail(Error{.file = {}, .place = {}, .value = topic, .rule = "is not a known topic", .advice = {}});
    if (message) return std::move(*message);
    Error error = message.error();
    error.file = place;
    throw error;
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
    if (version[0] >= '2') whole = " AND coalesce(checksum, '') <> 'damaged'";
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
    if (!std::filesystem::is_regular_file(file, none))
      return fail(Error{.file = file, .place = {}, .value = {}, .rule = "is not there", .advice = {}});
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
    std::string topic;
    std::string payload;
    session_->sql << "SELECT topic, payload FROM outputs WHERE message_id = :id" + session_->whole,
        use(message_id, "id"), into(topic), into(payload);
    if (!session_->sql.got_data()) return std::nullopt;
    return session_->message_of(topic, payload);
  });
}

Result<std::vector<Message>> JournalReader::outputs(Topic topic, const std::string& asset_id) {
  return session_->guard([&] {
    const std::string name = topic_name(topic);
    std::string payload;
    soci::statement query = (session_->sql.prepare << "SELECT payload FROM outputs WHERE topic = :topic AND asset_id ="
                                                      " :asset" +
                                                          session_->whole + " ORDER BY ordinal",
                             use(name, "topic"), use(asset_id, "asset"), into(payload));
    std::vector<Message> messages;
    query.execute();
    while (query.fetch()) messages.push_back(session_->message_of(name, payload));
    return messages;
  });
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

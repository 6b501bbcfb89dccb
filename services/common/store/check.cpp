// Whether a journal could be opened at a place, without leaving anything there.
#include <soci/soci.h>
#include <unistd.h>

#include <filesystem>

#include "services/common/store/connection_string.hpp"
#include "services/common/store/database.hpp"

namespace sealwatch {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kFile = "sqlite3://";
constexpr std::string_view kServer = "postgresql://";

Status check_file(const std::string& connection, const fs::path& file) {
  const auto refuse = [&](std::string rule, std::string advice) {
    return fail(Error{connection, "journal", file.string(), std::move(rule), std::move(advice)});
  };
  std::error_code none;
  if (file.empty() || (fs::exists(file, none) && !fs::is_regular_file(file, none)))
    return refuse("is not a file", "name one: sqlite3://FILE");
  if (fs::exists(file, none))
    return ::access(file.c_str(), R_OK | W_OK) == 0 ? Status()
                                                    : refuse("may not be written", "let this user write there");
  const fs::path directory = file.has_parent_path() ? file.parent_path() : fs::path(".");
  if (!fs::is_directory(directory, none))
    return refuse("its directory does not exist", "make it: mkdir -p " + directory.string());
  return ::access(directory.c_str(), W_OK) == 0 ? Status()
                                                : refuse("cannot be made there", "let this user write there");
}

}  // namespace

std::string Journal::file_of(const std::string& connection) {
  std::string text = connection.substr(kFile.size());
  if (const std::size_t name = text.find("dbname="); name != std::string::npos) {
    text = text.substr(name + 7);
    const bool quoted = !text.empty() && text.front() == '"';
    return quoted ? text.substr(1, text.find('"', 1) - 1) : text.substr(0, text.find(' '));
  }
  return text;
}

Status Journal::check_kind(const std::string& connection) {
  for (const std::string_view kind : {kFile, kServer})
    if (connection.starts_with(kind)) return {};
  return fail(Error{.file = without_password(connection),
                    .place = "journal",
                    .value = {},
                    .rule = "must be a connection string of SQLite or PostgreSQL",
                    .advice = "write sqlite3://FILE or postgresql://dbname=NAME"});
}

std::string Journal::place_of(const std::string& connection) {
  if (!connection.starts_with(kFile)) return connection;
  const fs::path file = fs::absolute(file_of(connection));
  std::error_code error;
  const fs::path found = fs::weakly_canonical(file, error);
  return std::string(kFile).append((error ? file.lexically_normal() : found).string());
}

Status Journal::check(const std::string& connection) {
  if (Status known = check_kind(connection); !known) return known;
  if (connection.starts_with(kFile)) return check_file(connection, file_of(connection));
  Database database;
  database.name = without_password(connection);
  return database.guard("connecting", [&] { open_session(database.sql, connection); });
}

}  // namespace sealwatch

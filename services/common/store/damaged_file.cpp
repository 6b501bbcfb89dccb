#include "services/common/store/damaged_file.hpp"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace sealwatch {
namespace {

namespace fs = std::filesystem;

/// Where SQLite's header says who may read and write the file: 1 and 2 all that know its two kinds of log, more only a
/// later SQLite.
constexpr std::streamoff kVersions = 18;

/// What stands beside a file that is to be moved aside when it is opened next.
std::string mark_of(const std::string& file) { return file + ".damaged"; }

/// Whether this user may read, write and move it: what SQLite cannot do then lies in the file.
bool is_in_our_hands(const std::string& file) {
  const fs::path directory = fs::path(file).parent_path();
  return ::access(file.c_str(), R_OK | W_OK) == 0 &&
         ::access(directory.empty() ? "." : directory.c_str(), W_OK | X_OK) == 0;
}

/// SQLite takes such a file for one of its future, and writes nothing to it.
bool is_of_no_version(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  stream.seekg(kVersions);
  const int write = stream.get(), read = stream.get();
  return stream.good() && (write > 2 || read > 2);
}

}  // namespace

bool is_damage(const std::string& file, std::string_view complaint) {
  complaint = complaint.substr(0, complaint.find(" while "));  // what follows are the row's values: people's words
  const auto says = [complaint](std::string_view words) { return complaint.find(words) != std::string_view::npos; };
  const bool damaged = says("malformed") || says("corrupt") || says("not a database") ||
                       says("unsupported file format") || says("no such table") || says("no such column") ||
                       says("no such index") || says("Cannot convert") || says("Null value fetched");
  const bool is_left_alone = says("readonly") && is_of_no_version(file);
  return (damaged || is_left_alone) && is_in_our_hands(file);
}

void note_damage(const std::string& file) { std::ofstream(mark_of(file)) << "\n"; }

bool is_known_damaged(const std::string& file) {
  std::error_code none;
  return fs::exists(mark_of(file), none);
}

void forget_damage(const std::string& file) {
  std::error_code none;
  fs::remove(mark_of(file), none);
}

std::string move_aside(const std::string& file) {
  std::string aside;
  for (int number = 1; aside.empty() || fs::exists(aside); ++number)
    aside = file + ".damaged-" + std::to_string(number);
  std::error_code failed;
  fs::rename(file, aside, failed);
  if (failed) throw std::runtime_error("unable to open: the damaged file cannot be moved aside: " + failed.message());
  std::error_code none;
  fs::rename(file + "-wal", aside + "-wal", none);
  fs::remove(file + "-shm", none);
  forget_damage(file);
  return aside;
}

void keep_acts_of(const std::string& aside, soci::session& sql) {
  try {
    sql << "ATTACH :file AS old", soci::use(aside, "file");
    try {
      sql << "INSERT INTO acts SELECT * FROM old.acts ORDER BY sequence";
    } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): then it is in the old file alone, which is kept
    }
    sql << "DETACH old";
  } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): as above
  }
}

}  // namespace sealwatch

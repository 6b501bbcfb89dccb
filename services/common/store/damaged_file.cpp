#include "services/common/store/damaged_file.hpp"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <vector>

namespace sealwatch {
namespace {

namespace fs = std::filesystem;

/// Where SQLite's header says who may read and write the file: 1 and 2 all that know its two kinds of log, more only a
/// later SQLite.
constexpr std::streamoff kVersions = 18;

/// What stands beside a file that is to be moved aside when it is opened next.
std::string mark_of(const std::string& file) { return file + ".damaged"; }

bool may(const std::string& path, int how) { return ::access(path.c_str(), how) == 0; }

bool may_move(const std::string& file) {
  const std::string directory = fs::path(file).parent_path().string();
  return may(directory.empty() ? "." : directory, W_OK | X_OK);
}

/// Whether this user may read, write and move it: what SQLite cannot do then lies in the file.
bool is_in_our_hands(const std::string& file) { return may(file, R_OK | W_OK) && may_move(file); }

/// The file and its log, as far as they are there.
std::vector<std::string> files_of(const std::string& file) {
  std::vector<std::string> files;
  for (const std::string& path : {file, file + "-wal"})
    if (may(path, F_OK)) files.push_back(path);
  return files;
}

bool may_all(const std::vector<std::string>& files, int how) {
  return std::ranges::all_of(files, [how](const std::string& path) { return may(path, how); });
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

std::optional<std::string> make_accessible(const std::string& file) {
  const std::vector<std::string> files = files_of(file);
  if (may_all(files, R_OK | W_OK) || !may_move(file)) return std::nullopt;
  std::error_code none;
  for (const std::string& path : files)
    fs::permissions(path, fs::perms::owner_read | fs::perms::owner_write, fs::perm_options::add, none);
  if (may_all(files, R_OK | W_OK))
    return "the journal's files could not be read or written, and have their rights back";
  const bool is_readable = may_all(files, R_OK);
  const std::string aside = move_aside(file);
  if (!is_readable)
    return "the journal's files may not be read by this user, and are now " + aside +
           "; it is made again from the neighbours' messages: give them to this user and put them back while the "
           "service is stopped";
  for (const std::string& path : files) fs::copy_file(aside + path.substr(file.size()), path);
  return "the journal's files were another user's, and are now " + aside + "; a copy is in their place";
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

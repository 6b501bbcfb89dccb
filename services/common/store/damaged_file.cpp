#include "services/common/store/damaged_file.hpp"

#include <array>
#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace sealwatch {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMagic("SQLite format 3\0", 16);
/// A turned bit or two in the magic leave more of it than this.
constexpr int kMagicLeft = 12;

/// What stands beside a file that is to be moved aside when it is opened next.
std::string mark_of(const std::string& file) { return file + ".damaged"; }

bool was_a_database(const std::string& file) {
  std::array<char, kMagic.size()> begin{};
  std::ifstream(file, std::ios::binary).read(begin.data(), begin.size());
  int same = 0;
  for (std::size_t k = 0; k < kMagic.size(); ++k) same += begin[k] == kMagic[k] ? 1 : 0;
  return same >= kMagicLeft;
}

}  // namespace

bool is_damage(const std::string& file, std::string_view complaint) {
  complaint = complaint.substr(0, complaint.find(" while "));  // what follows are the row's values: people's words
  const auto says = [complaint](std::string_view words) { return complaint.find(words) != std::string_view::npos; };
  const bool damaged = says("malformed") || says("corrupt") || says("not a database") ||
                       says("unsupported file format") || says("no such table") || says("no such column") ||
                       says("Cannot convert") || says("Null value fetched");
  return damaged && was_a_database(file);
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

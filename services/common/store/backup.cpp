#include "services/common/store/backup.hpp"

#include <fcntl.h>
#include <soci/soci.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <stdexcept>

#include "services/common/store/damaged_file.hpp"
#include "services/common/store/journal.hpp"
#include "services/common/store/journal_lock.hpp"
#include "services/common/store/journal_reader.hpp"

namespace sealwatch {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFile = "sqlite3://";

tl::unexpected<Error> refuse(const std::string& file, std::string rule, std::string advice) {
  return fail(Error{.file = file, .place = {}, .value = {}, .rule = std::move(rule), .advice = std::move(advice)});
}

/// A file or directory with all that was written to it.
bool bring_to_disk(const fs::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return false;
  const bool done = ::fsync(descriptor) == 0;
  ::close(descriptor);
  return done;
}

/// Renames what is whole to its name: who finds the name finds all of it, after a power cut too.
Status put_in_place(const fs::path& part, const fs::path& file) {
  std::error_code failed;
  bool done = bring_to_disk(part);
  if (done) fs::rename(part, file, failed);
  done = done && !failed && bring_to_disk(file.has_parent_path() ? file.parent_path() : fs::path("."));
  if (done) return {};
  fs::remove(part, failed);
  return refuse(file.string(), "could not be written", "free some space on the disk");
}

/// What root puts into a service's folder belongs to the service, which must write to it.
void give_to_owner_of(const fs::path& folder, const fs::path& file) {
  std::error_code none;
  fs::permissions(file, fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_read, none);
  struct stat owner {};
  if (::geteuid() == 0 && ::stat(folder.c_str(), &owner) == 0) (void)!::chown(file.c_str(), owner.st_uid, owner.st_gid);
}

/// All of the log goes into the file: without it what was confirmed would be lost if the two were parted.
void end_log(const std::string& file) {
  try {
    soci::session sql(std::string(kFile) + "dbname=\"" + file + "\" timeout=5");
    sql << "PRAGMA wal_checkpoint(TRUNCATE)";
  } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): a damaged file; both are kept as they are
  }
}

/// SQLite's own look at every page and index.
Status check_whole(const std::string& file, const std::string& service) {
  if (const auto readable = JournalReader::open(kFile + file, service); !readable) return fail(readable.error());
  std::string answer;
  try {
    soci::session sql(std::string(kFile) + "dbname=\"" + file + "\" readonly=true");
    sql << "PRAGMA integrity_check(1)", soci::into(answer);
  } catch (const std::exception& exception) {
    answer = exception.what();
  }
  if (answer == "ok") return {};
  return refuse(file, "is damaged: " + answer, "take another backup");
}

}  // namespace

Status back_up_journal(const std::string& connection, const std::string& service, const std::string& copy) {
  if (!connection.starts_with(kFile))
    return refuse(without_password(connection), "is a journal in a server",
                  "back it up with the server's own tools: pg_dump");
  std::error_code none;
  if (fs::exists(copy, none))
    return refuse(copy, "is there already", "name a new directory: no backup is written over");
  if (const auto readable = JournalReader::open(connection, service); !readable) return fail(readable.error());
  const std::string part = copy + ".part";
  fs::remove(part, none);
  try {
    soci::session sql(std::string(kFile) + "dbname=\"" + Journal::file_of(connection) + "\" readonly=true timeout=5");
    sql << "VACUUM INTO :file", soci::use(part, "file");
  } catch (const std::exception& exception) {
    fs::remove(part, none);
    return refuse(copy, exception.what(), "check that there is room, and that this user may read the journal");
  }
  if (Status whole = check_whole(part, service); !whole) {
    fs::remove(part, none);
    return whole;
  }
  return put_in_place(part, copy);
}

Status check_copy(const std::string& copy, const std::string& connection, const std::string& service) {
  if (!connection.starts_with(kFile))
    return refuse(without_password(connection), "is a journal in a server",
                  "restore it with the server's own tools: pg_restore");
  return check_whole(copy, service);
}

Result<std::string> restore_journal(const std::string& copy, const std::string& connection,
                                    const std::string& service) {
  if (Status whole = check_copy(copy, connection, service); !whole) return fail(whole.error());
  const std::string file = Journal::file_of(connection);
  std::error_code failed;
  if (const fs::path folder = fs::path(file).parent_path(); !folder.empty()) fs::create_directories(folder, failed);
  auto lock = JournalLock::take(file);
  if (!lock) return fail(lock.error());
  fs::path folder = fs::path(file).parent_path();
  if (folder.empty()) folder = ".";
  give_to_owner_of(folder, file + ".lock");
  const std::string part = file + ".part";
  fs::copy_file(copy, part, fs::copy_options::overwrite_existing, failed);
  if (failed) return refuse(part, failed.message(), "free some space on the disk");
  give_to_owner_of(folder, part);
  std::string aside;
  for (int number = 1; fs::exists(file) && (aside.empty() || fs::exists(aside)); ++number)
    aside = file + ".replaced-" + std::to_string(number);
  if (!aside.empty()) {
    end_log(file);
    // The log first: beside the restored file it would be taken for that file's own.
    fs::rename(file + "-wal", aside + "-wal", failed);
    fs::rename(file, aside, failed);
    if (failed) return refuse(file, failed.message(), "let this user write there");
  }
  fs::remove(file + "-shm", failed);
  if (Status placed = put_in_place(part, file); !placed) {
    Error error = placed.error();
    if (!aside.empty()) error.advice += "; what was there is now " + aside;
    return fail(std::move(error));
  }
  forget_damage(file);
  if (const auto placed = JournalReader::open(connection, service); placed)
    lock->remember({.writer_id = placed->writer_id()});
  give_to_owner_of(folder, JournalLock::mark_file_of(file));
  return aside;
}

}  // namespace sealwatch

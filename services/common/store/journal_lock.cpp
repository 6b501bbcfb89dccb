#include "services/common/store/journal_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

namespace sealwatch {
namespace {

constexpr const char* kAdvice =
    "a journal belongs to one service on one machine: stop the other, or give this one its own";

/// "MACHINE, process N": what is read by who finds the lock taken.
std::string this_process() {
  std::array<char, 256> machine{};
  ::gethostname(machine.data(), machine.size() - 1);
  return std::string(machine.data()) + ", process " + std::to_string(::getpid());
}

}  // namespace

Result<JournalLock> JournalLock::take(const std::string& journal_file) {
  const std::string file = journal_file + ".lock";
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor < 0)
    return fail(Error{.file = journal_file,
                      .place = "journal",
                      .value = {},
                      .rule = "unable to open its lock: " + std::string(std::strerror(errno)),
                      .advice = "check that the directory exists and that this user may write to it"});
  JournalLock lock(file, descriptor);
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
    std::array<char, 300> owner{};
    const bool known = ::read(descriptor, owner.data(), owner.size() - 1) > 0;
    return fail(Error{.file = journal_file,
                      .place = "journal",
                      .value = known ? owner.data() : "",
                      .rule = "another process works with this journal",
                      .advice = kAdvice});
  }
  const std::string owner = this_process();
  // For people alone: the lock holds where it cannot be written, too.
  if (::ftruncate(descriptor, 0) == 0) (void)!::pwrite(descriptor, owner.data(), owner.size(), 0);
  return lock;
}

JournalLock::~JournalLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

bool JournalLock::holds() const {
  struct stat held {};
  struct stat there {};
  return ::fstat(descriptor_, &held) == 0 && ::stat(file_.c_str(), &there) == 0 && held.st_ino == there.st_ino &&
         held.st_dev == there.st_dev;
}

std::optional<Error> lock_schema(soci::session& sql, const std::string& name) {
  int taken = 0;
  sql << "SELECT CASE WHEN pg_try_advisory_lock(hashtext('sealwatch journal ' || current_schema())) THEN 1 ELSE 0 END",
      soci::into(taken);
  if (taken == 1) return std::nullopt;
  return Error{.file = name,
               .place = "journal",
               .value = {},
               .rule = "another process works with this journal",
               .advice = kAdvice};
}

}  // namespace sealwatch

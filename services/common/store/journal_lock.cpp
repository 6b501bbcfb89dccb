#include "services/common/store/journal_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>

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

/// Behind the line of the process.
constexpr std::string_view kMark = "\njournal ";
constexpr std::string_view kConclusions = ", conclusions ";
constexpr std::string_view kAt = ", at ";

std::optional<JournalMark> mark_in(std::string_view text) {
  const std::size_t mark = text.find(kMark);
  const std::size_t count = mark == std::string_view::npos ? mark : text.find(kConclusions, mark);
  const std::size_t at = count == std::string_view::npos ? count : text.find(kAt, count);
  if (at == std::string_view::npos) return std::nullopt;
  const auto number = [text](std::size_t begin, long long& value) {
    return std::from_chars(text.data() + begin, text.data() + text.size(), value).ec == std::errc();
  };
  JournalMark found;
  found.writer_id = text.substr(mark + kMark.size(), count - mark - kMark.size());
  const bool is_whole = number(count + kConclusions.size(), found.conclusions) && number(at + kAt.size(), found.at_ns);
  return is_whole && !found.writer_id.empty() ? std::optional(found) : std::nullopt;
}

std::string read_from(int descriptor) {
  std::array<char, 600> content{};
  const ssize_t size = ::pread(descriptor, content.data(), content.size(), 0);
  return {content.data(), static_cast<std::size_t>(std::max<ssize_t>(size, 0))};
}

/// A pipe of that name is not waited for, here and where it is written.
std::string content_of(const std::string& file) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return {};
  std::string text = read_from(descriptor);
  ::close(descriptor);
  return text;
}

void write_to(int descriptor, const std::string& text) {
  if (::pwrite(descriptor, text.data(), text.size(), 0) == static_cast<ssize_t>(text.size()))
    (void)!::ftruncate(descriptor, static_cast<off_t>(text.size()));
}

}  // namespace

std::string JournalLock::mark_file_of(const std::string& journal_file) {
  const std::filesystem::path file(journal_file);
  return file.extension() == ".mark" ? journal_file + ".mark"
                                     : std::filesystem::path(file).replace_extension("mark").string();
}

Result<JournalLock> JournalLock::take(const std::string& journal_file) {
  const std::string file = journal_file + ".lock";
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor < 0)
    return fail(Error{.file = journal_file,
                      .place = "journal",
                      .value = {},
                      .rule = "unable to open its lock: " + std::string(std::strerror(errno)),
                      .advice = "check that the directory exists and that this user may write to it"});
  JournalLock lock(journal_file, descriptor);
  const bool is_taken = ::flock(descriptor, LOCK_EX | LOCK_NB) != 0;
  const std::string text = read_from(descriptor);
  if (is_taken)
    return fail(Error{.file = journal_file,
                      .place = "journal",
                      .value = text.substr(0, text.find('\n')),
                      .rule = "another process works with this journal",
                      .advice = kAdvice});
  lock.last_ = mark_in(text);
  if (!lock.last_) lock.last_ = mark_in(content_of(lock.mark_file_));
  lock.write();
  return lock;
}

void JournalLock::remember(const JournalMark& mark) {
  last_ = mark;
  write();
}

/// The lock holds where it cannot be written, too.
void JournalLock::write() const {
  std::string text = this_process();
  if (last_) {
    text.append(kMark).append(last_->writer_id);
    text.append(kConclusions).append(std::to_string(last_->conclusions));
    text.append(kAt).append(std::to_string(last_->at_ns)).append("\n");
  }
  write_to(descriptor_, text);
  if (!last_ || !holds()) return;
  const int mark = ::open(mark_file_.c_str(), O_WRONLY | O_CREAT | O_NONBLOCK | O_CLOEXEC | O_NOFOLLOW, 0644);
  if (mark < 0) return;
  write_to(mark, text);
  ::close(mark);
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
  std::string schema;
  soci::indicator there = soci::i_null;
  sql << "SELECT current_schema()", soci::into(schema, there);
  if (there == soci::i_null)
    return Error{.file = name,
                 .place = "journal",
                 .value = {},
                 .rule = "its schema is not there: it was dropped or renamed, or search_path names another",
                 .advice = "restore it from the server's backup; or CREATE SCHEMA, and the service makes it again"};
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

// Keeps a second process, on this machine or on another, away from a journal while it is open for writing.
#pragma once

#include <soci/soci.h>

#include <optional>
#include <string>
#include <utility>

#include "sealwatch/core/result.hpp"

namespace sealwatch {

/// Which journal this is, how far it goes at least, and when it was so.
struct JournalMark {
  std::string writer_id;
  long long conclusions = 0;
  long long at_ns = 0;
};

/// On "FILE.lock" (flock, which NFS carries to other machines). The kernel lets go of it however the process ends. It
/// remembers the journal that was used last: another in its place, an older copy of it, or none, is noticed. So does a
/// file that has not the journal's name in its own: who removes "FILE*" of all services leaves no neighbour that knows.
class JournalLock {
 public:
  [[nodiscard]] static Result<JournalLock> take(const std::string& journal_file);
  ~JournalLock();
  JournalLock(JournalLock&& other) noexcept
      : file_(std::move(other.file_)),
        mark_file_(std::move(other.mark_file_)),
        descriptor_(std::exchange(other.descriptor_, -1)),
        last_(std::move(other.last_)) {}
  JournalLock& operator=(JournalLock&&) = delete;

  /// Whether the file that is locked is still the one that others would try to lock: somebody may have removed it.
  [[nodiscard]] bool holds() const;
  /// The journal that was used here last, as far as that is known.
  [[nodiscard]] const std::optional<JournalMark>& last() const { return last_; }
  void remember(const JournalMark& mark);
  /// "state/SERVICE.mark" of "state/SERVICE.db".
  [[nodiscard]] static std::string mark_file_of(const std::string& journal_file);

 private:
  void write() const;
  JournalLock(const std::string& journal_file, int descriptor)
      : file_(journal_file + ".lock"), mark_file_(mark_file_of(journal_file)), descriptor_(descriptor) {}
  std::string file_;
  std::string mark_file_;
  int descriptor_ = -1;
  std::optional<JournalMark> last_;
};

/// The same in PostgreSQL, for as long as the session lasts; an Error where another session has it. Throws what SOCI
/// throws.
[[nodiscard]] std::optional<Error> lock_schema(soci::session& sql, const std::string& name);

}  // namespace sealwatch

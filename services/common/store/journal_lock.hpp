// Keeps a second process, on this machine or on another, away from a journal while it is open for writing.
#pragma once

#include <soci/soci.h>

#include <optional>
#include <string>
#include <utility>

#include "sealwatch/core/result.hpp"

namespace sealwatch {

/// On "FILE.lock" (flock, which NFS carries to other machines). The kernel lets go of it however the process ends.
class JournalLock {
 public:
  [[nodiscard]] static Result<JournalLock> take(const std::string& journal_file);
  ~JournalLock();
  JournalLock(JournalLock&& other) noexcept
      : file_(std::move(other.file_)), descriptor_(std::exchange(other.descriptor_, -1)) {}
  JournalLock& operator=(JournalLock&&) = delete;

  /// Whether the file that is locked is still the one that others would try to lock: somebody may have removed it.
  [[nodiscard]] bool holds() const;

 private:
  JournalLock(std::string file, int descriptor) : file_(std::move(file)), descriptor_(descriptor) {}
  std::string file_;
  int descriptor_ = -1;
};

/// The same in PostgreSQL, for as long as the session lasts; an Error where another session has it. Throws what SOCI
/// throws.
[[nodiscard]] std::optional<Error> lock_schema(soci::session& sql, const std::string& name);

}  // namespace sealwatch

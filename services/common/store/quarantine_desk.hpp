// What a service has set aside (journal.hpp), from outside, whether it runs or not: to look at, and to have tried again.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sealwatch/core/result.hpp"
#include "sealwatch/core/time.hpp"
#include "services/common/store/journal.hpp"

namespace sealwatch {

class QuarantineDesk {
 public:
  /// A journal that is not there is not made.
  [[nodiscard]] static Result<QuarantineDesk> open(const std::string& connection, const std::string& service);
  ~QuarantineDesk();
  QuarantineDesk(QuarantineDesk&& other) noexcept;
  QuarantineDesk& operator=(QuarantineDesk&& other) noexcept;

  struct Entry {
    SetAside message;
    std::string state;     ///< "set_aside", "retry": asked for, not yet done; "released": it was tried again
    std::string asked_by;  ///< who had it tried again last; ""
    std::int64_t asked_ns = 0;
  };
  /// All that was ever set aside, the oldest first.
  [[nodiscard]] Result<std::vector<Entry>> list();
  /// Has it tried again: at once where the service runs, else when it starts. False when it is not set aside.
  [[nodiscard]] Result<bool> ask_again(const std::string& message_id, const std::string& who, UtcTime now);

 private:
  struct Session;
  explicit QuarantineDesk(std::unique_ptr<Session> session);
  std::unique_ptr<Session> session_;
};

}  // namespace sealwatch

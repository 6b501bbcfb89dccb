// A copy of a journal, made while its service runs, and its way back.
#pragma once

#include <string>

#include "sealwatch/core/result.hpp"

namespace sealwatch {

/// Writes the journal, as it is at one moment, to a file that is not there yet. Its service goes on. SQLite only.
[[nodiscard]] Status back_up_journal(const std::string& connection, const std::string& service,
                                     const std::string& copy);
/// Whether restore_journal would take the copy for this journal, whoever has the journal open; nothing is changed.
[[nodiscard]] Status check_copy(const std::string& copy, const std::string& connection, const std::string& service);
/// Puts such a copy in the place of the journal, whose service must not run; the journal that was there is moved aside,
/// and returned is where it is now ("": there was none). A copy that is damaged, another service's or a newer program's
/// is refused before anything is changed.
[[nodiscard]] Result<std::string> restore_journal(const std::string& copy, const std::string& connection,
                                                  const std::string& service);

}  // namespace sealwatch

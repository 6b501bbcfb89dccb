// A SQLite file in which the database cannot find its way any more, as a page or its header was changed.
#pragma once

#include <soci/soci.h>

#include <optional>
#include <string>
#include <string_view>

namespace sealwatch {

/// Whether the complaint says so of this file. One that this user may not write to is no damage. One that never was a
/// database is: it cannot be told from a journal whose first page was lost, and moving it aside loses nothing.
[[nodiscard]] bool is_damage(const std::string& file, std::string_view complaint);
/// A file, or its log, that this user may not read or write gets its rights back where it is this user's. Where it is
/// another's it is moved aside, and a copy takes its place if it may be read. Returned is what was done; none where
/// nothing was to be done, or could be.
[[nodiscard]] std::optional<std::string> make_accessible(const std::string& file);
/// So that the next to open the file knows: damage may lie where nothing is read at the start.
void note_damage(const std::string& file);
[[nodiscard]] bool is_known_damaged(const std::string& file);
/// Another file is in its place.
void forget_damage(const std::string& file);
/// Moves file and log away, and returns where the file is now. Throws std::runtime_error where that cannot be done.
[[nodiscard]] std::string move_aside(const std::string& file);
/// Copies what can be read of the record of acts.
void keep_acts_of(const std::string& aside, soci::session& sql);

}  // namespace sealwatch

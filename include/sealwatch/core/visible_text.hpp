// Text of strangers (ids, names and remarks of messages, file names) made fit for a terminal, a log and a command to
// paste: the one owner. A terminal obeys control characters, a log's reader is misled by line breaks, a shell by its
// metacharacters; bytes that are no UTF-8 end a JSON writer.
#pragma once

#include <string>
#include <string_view>

namespace sealwatch {

/// Whether `text` is UTF-8 (RFC 3629).
[[nodiscard]] bool is_valid_utf8(std::string_view text);
/// Whether it is UTF-8 without what a reader does not see: control and format characters (zero width, direction of
/// writing) and, as two names must not look the same, any white space but a blank. With `several_lines` it is running
/// text: line breaks, tabs and other white space may stand in it, and what joins letters (Persian, emoji).
[[nodiscard]] bool is_visible(std::string_view text, bool several_lines = false);
/// The same text where it is visible; else with "\xHH" for every byte that is not.
[[nodiscard]] std::string visible(std::string_view text, bool several_lines = true);
/// The same text without what a reader does not see: white space, control and format characters of Unicode.
[[nodiscard]] std::string without_blanks(std::string_view text);
/// One word of a POSIX shell: as it stands where no character of it means anything to a shell, else in single quotes.
[[nodiscard]] std::string shell_word(std::string_view text);

}  // namespace sealwatch

// Identifiers, lists and lines as people read them.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace sealwatch::text {

/// "not_judged" as "not judged", "sensor:flow" as "sensor: flow", "pressure_a" as "pressure A".
[[nodiscard]] std::string in_words(std::string_view identifier);

/// "a, b, c"; with `last` before the last one: "a, b and c".
[[nodiscard]] std::string joined(const std::vector<std::string>& parts, std::string_view last = ", ");
/// With `between` everywhere: "a; b; c".
[[nodiscard]] std::string separated(const std::vector<std::string>& parts, std::string_view between = "; ");
/// `part` behind the list that `text` is: "a", then "a, b".
void add_to_list(std::string& text, std::string_view part, std::string_view between = ", ");

/// "1 test", "2 tests".
[[nodiscard]] std::string count_of(std::size_t count, std::string_view thing);

/// Between quotation marks as YAML reads it: control characters are blanks.
[[nodiscard]] std::string quoted(std::string_view text);

/// Characters of UTF-8 text.
[[nodiscard]] std::size_t letters(std::string_view text);
/// `text` and blanks up to `width` characters.
[[nodiscard]] std::string padded(std::string_view text, std::size_t width);
/// Where the first word of `text` ends: at a blank, but a number and its percent sign are one word.
[[nodiscard]] std::size_t end_of_word(std::string_view text);
/// Breaks `text` into lines of at most `width` characters between words, each later line behind `indent` blanks.
[[nodiscard]] std::string wrapped(std::string_view text, std::size_t width, std::size_t indent);

}  // namespace sealwatch::text

// Small helpers for messages that people read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sealwatch {

/// Damerau-Levenshtein distance (optimal string alignment); upper and lower case count as the same letter.
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b);

/// The candidate nearest to `word` by edit distance (insert, delete, replace, swap of neighbours), or "" when none
/// is closer than half the word's length.
[[nodiscard]] std::string nearest(std::string_view word, std::span<const std::string> candidates);

/// "did you mean 'X'?" for the nearest candidate, else "known are: A, B, C".
[[nodiscard]] std::string suggest(std::string_view word, std::span<const std::string> candidates);

/// First 16 hex digits of the 64-bit FNV-1a hash of `bytes`: names contents, does not protect them.
[[nodiscard]] std::string content_hash(std::string_view bytes);

/// The same hash of bytes that come in pieces.
class ContentHasher {
 public:
  void add(std::string_view bytes);
  [[nodiscard]] std::string hex() const;

 private:
  std::uint64_t hash_ = 14695981039346656037ULL;  // FNV offset basis
};

/// The line, from 1, on which a second YAML document begins in `text`; 0: none. By its mark at the start of a line:
/// yaml-cpp's LoadAll does not end on some damaged texts.
[[nodiscard]] int line_of_second_document(std::string_view text);

}  // namespace sealwatch

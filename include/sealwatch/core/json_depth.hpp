// How deep a JSON text from outside may be nested. Whoever reads or writes a document tree calls itself once for each
// level: a line of a megabyte of brackets ends the process. Asked of the text, before anything is made of it.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace sealwatch {

/// Our own texts have fewer than ten levels.
inline constexpr std::size_t kDeepestJson = 64;
inline const std::string kNestedTooDeeply = "is nested deeper than " + std::to_string(kDeepestJson) + " levels";

/// Brackets inside strings do not count; of what is no JSON the answer means nothing but that it may be parsed.
[[nodiscard]] inline bool is_nested_too_deeply(std::string_view json) {
  std::size_t depth = 0;
  bool quoted = false;
  for (std::size_t k = 0; k < json.size(); ++k) {
    const char letter = json[k];
    if (quoted && letter == '\\') {
      ++k;
    } else if (letter == '"') {
      quoted = !quoted;
    } else if (!quoted && (letter == '[' || letter == '{')) {
      if (++depth > kDeepestJson) return true;
    } else if (!quoted && (letter == ']' || letter == '}') && depth > 0) {
      --depth;
    }
  }
  return false;
}

}  // namespace sealwatch

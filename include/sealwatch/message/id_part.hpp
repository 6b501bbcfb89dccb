// A name as part of the id of a test, which stands in paths, commands and names of files: the one owner.
#pragma once

#include <cctype>
#include <string>
#include <string_view>

namespace sealwatch {

/// Characters other than letters, digits, '-' and '.' become '_': of two names with the same result the ids are the same.
[[nodiscard]] inline std::string id_part(std::string_view name) {
  std::string result;
  for (const char letter : name) {
    const bool allowed = std::isalnum(static_cast<unsigned char>(letter)) != 0 || letter == '-' || letter == '.';
    result += allowed ? letter : '_';
  }
  return result;
}

}  // namespace sealwatch

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

/// Tests that differ in content have ids that differ, and messages of one id are told apart by their assets: no reason
/// to refuse what has a history under these ids.
[[nodiscard]] inline std::string alike_in_ids(const std::string& asset_id, const std::string& other) {
  return "asset '" + asset_id +
         "': all but ASCII letters, digits, '-' and '.' is '_' in the ids of its tests, as of '" + other +
         "': two that begin at the same time with the same content have one id; " +
         "both assets are taken, as before, but give new ones ids that differ there";
}

}  // namespace sealwatch

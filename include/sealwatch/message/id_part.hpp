// A name as part of an id, which stands in paths, commands and names of files: the one owner.
#pragma once

#include <cctype>
#include <string>
#include <string_view>

#include "sealwatch/core/text.hpp"
#include "sealwatch/message/topics.hpp"

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

/// An id of a stranger's that is part of ours stays well below the longest one.
[[nodiscard]] inline std::string short_part(const std::string& id) {
  constexpr std::size_t kLongestPart = 200;
  return id.size() > kLongestPart ? content_hash(id) : id;
}

/// Senders that name blocks by recording and number alone give the same ids to tests of several assets, and so do assets
/// that are alike in the ids of their tests: under this one the message is kept where its own is that of another asset's.
[[nodiscard]] inline std::string id_beside_another_asset(const Message& message) {
  return short_part(header_of(message).message_id) + "@" + asset_of(message);
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

// What an asset may be called: people tell assets apart by their ids and type them behind commands.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "sealwatch/core/visible_text.hpp"

namespace sealwatch {

/// Bytes. The id of an act has that of its asset up to three times in it (the confirmed retraction of a test), and the
/// longest id (longest_id.hpp) must hold it.
inline constexpr std::size_t kLongestAssetId = 80;

/// Why no asset may have this id; none of an empty one, which is no asset's.
[[nodiscard]] inline std::optional<std::string> fault_of_asset_id(std::string_view id) {
  if (!is_visible(id)) return "must not have line breaks, other control characters or invisible ones";
  if (id.size() > kLongestAssetId) return "must not be longer than " + std::to_string(kLongestAssetId) + " bytes";
  if (id.starts_with(' ') || id.ends_with(' ')) return "must not begin or end with a blank, which nobody sees";
  if (id.starts_with('-')) return "must not begin with '-': commands would take it for an option";
  return std::nullopt;
}

}  // namespace sealwatch

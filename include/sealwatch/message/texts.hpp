// Every text in a message, by its field's name, however deep: for rules that hold for all of them.
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "sealwatch/core/fields.hpp"

namespace sealwatch {

/// Calls `take(name, text)` for every string of `value`, a described struct, string or vector of those; the strings may
/// be changed where `value` may be.
template <class Value, class Take>
void for_each_text(std::string_view name, Value& value, const Take& take) {
  using Plain = std::remove_const_t<Value>;
  if constexpr (std::is_same_v<Plain, std::string>) {
    take(name, value);
  } else if constexpr (Described<Plain>) {
    Plain::visit([&take](std::string_view field, auto& content) { for_each_text(field, content, take); }, value);
  } else if constexpr (requires { typename Plain::value_type; }) {
    if constexpr (!std::is_arithmetic_v<typename Plain::value_type>)
      for (auto& one : value) for_each_text(name, one, take);
  }
}

/// Whether the field holds a name that others refer to, not free words: "pst_id", "source_ids", a channel's name and unit.
[[nodiscard]] inline bool names_something(std::string_view field) {
  constexpr std::array<std::string_view, 4> kNames = {"name", "unit", "channel", "test_kind"};
  return field.ends_with("_id") || field.ends_with("_ids") || std::ranges::find(kNames, field) != kNames.end();
}

}  // namespace sealwatch

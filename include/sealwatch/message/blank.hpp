// A message of a topic that is known only when the program runs.
#pragma once

#include "sealwatch/message/topics.hpp"

namespace sealwatch {

/// Its fields as they are by default.
template <std::size_t index = 0>
[[nodiscard]] Message blank_message(Topic topic) {
  if constexpr (index + 1 < std::variant_size_v<MessageAlternatives>) {
    if (static_cast<std::size_t>(topic) != index) return blank_message<index + 1>(topic);
  }
  return Message(std::in_place_index<index>);
}

}  // namespace sealwatch

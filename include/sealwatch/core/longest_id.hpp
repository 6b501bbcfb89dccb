// How long an id may be: of an asset, a recording, a message.
#pragma once

#include <cstddef>

namespace sealwatch {

inline constexpr std::size_t kLongestId = 500;  ///< bytes

}  // namespace sealwatch

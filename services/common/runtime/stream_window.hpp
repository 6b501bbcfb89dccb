// How many messages of one stream may be on their way to a reader: what a reader asks for at a time and holds back
// beyond a gap, what a writer keeps that the bus did not take, and how far a sender goes ahead of the position that its
// reader confirms. A window of a test has about a megabyte, a block of samples about 20 kB, all else a few kB.
#pragma once

#include <cstdint>
#include <string_view>

#include "sealwatch/message/outside.hpp"

namespace sealwatch {

[[nodiscard]] constexpr std::uint64_t stream_window(std::string_view topic) {
  if (topic == "test_window") return 16;
  if (topic == "raw_samples" || topic == "sample_block") return 128;
  return 256;
}

}  // namespace sealwatch

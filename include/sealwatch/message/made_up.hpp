// Tests that no actuator did: the virtual bench says so by its source_id, and their PST id ends in "-simulated", so that
// whatever is concluded from them says so.
#pragma once

#include <string_view>

namespace sealwatch {

inline constexpr std::string_view kVirtualBench = "virtual_bench";
inline constexpr std::string_view kEndOfMadeUpId = "-simulated";

[[nodiscard]] inline bool is_made_up(std::string_view source_id) { return source_id == kVirtualBench; }
[[nodiscard]] inline bool is_made_up_test(std::string_view pst_id) { return pst_id.ends_with(kEndOfMadeUpId); }

}  // namespace sealwatch

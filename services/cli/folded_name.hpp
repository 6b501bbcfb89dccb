// Two names that look alike: the same but for capitals, or for how a letter with a mark is written in Unicode.
#pragma once

#include <string>
#include <string_view>

namespace sealwatch::cli {

/// The same text for names that are alike: letters small, and apart from their marks (NFD of the case folding), which
/// stand in one order. Other scripts than those below U+2000 stay as they are.
[[nodiscard]] std::string folded_name(std::string_view utf8);

}  // namespace sealwatch::cli

// The files of config/plants, as text (made by CMake from built_in_texts.cpp.in): a plant that is built in under the name
// of one of them has the same equations, which can be written out.
#pragma once

#include <string_view>

namespace sealwatch {

/// The file's text; "" where there is none of that name.
[[nodiscard]] std::string_view text_of_built_in(std::string_view plant);

}  // namespace sealwatch

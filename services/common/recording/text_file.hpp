// Files of text: Windows' tools write UTF-16 with its mark as "Unicode text", which is read as if it were UTF-8.
#pragma once

#include <istream>
#include <memory>
#include <string>
#include <string_view>

#include "sealwatch/core/result.hpp"

namespace sealwatch {

/// The UTF-8 of a UTF-16 text that begins with its mark; an Error of the place where it is none.
[[nodiscard]] Result<std::string> utf8_of_utf16(std::string_view text);

/// The file of that name, opened for reading as UTF-8 or a one-byte encoding.
[[nodiscard]] Result<std::unique_ptr<std::istream>> open_text(const std::string& path);

}  // namespace sealwatch

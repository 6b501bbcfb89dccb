// Bytes as text, and numbers as base64 of little-endian doubles: bit-exact and fast.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace sealwatch {

void append_base64(std::string_view bytes, std::string& text);
/// False where the text is no base64; `bytes` is then spoilt.
[[nodiscard]] bool from_base64(std::string_view text, std::string& bytes);
void append_base64(const std::vector<double>& values, std::string& text);
/// False where the text is no base64 of doubles.
[[nodiscard]] bool from_base64(std::string_view text, std::vector<double>& values);

}  // namespace sealwatch

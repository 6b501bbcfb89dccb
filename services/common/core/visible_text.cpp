#include "sealwatch/core/visible_text.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>

#include "services/common/text/format.hpp"

namespace sealwatch {
namespace {

struct Letter {
  std::size_t length = 1;  ///< bytes
  std::uint32_t code = 0;
  bool valid = false;
};

/// The letter that begins at `text`, which is not empty.
Letter first_letter(std::string_view text) {
  const auto byte = [&](std::size_t k) { return static_cast<std::uint32_t>(static_cast<unsigned char>(text[k])); };
  const std::uint32_t lead = byte(0);
  if (lead < 0x80) return {1, lead, true};
  const std::size_t length = lead < 0xC2 ? 0 : lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : lead < 0xF5 ? 4 : 0;
  if (length == 0 || text.size() < length) return {};
  std::uint32_t code = lead & (0x7FU >> length);
  for (std::size_t k = 1; k < length; ++k) {
    if ((byte(k) & 0xC0U) != 0x80U) return {};
    code = code << 6U | (byte(k) & 0x3FU);
  }
  constexpr std::array<std::uint32_t, 5> kLeast = {0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = code >= 0xD800 && code <= 0xDFFF;
  if (code < kLeast[length] || code > 0x10FFFF || surrogate) return {};
  return {length, code, true};
}

bool turns_direction(std::uint32_t code) {
  return (code >= 0x202A && code <= 0x202E) || (code >= 0x2066 && code <= 0x2069);
}

bool is_harmless(const Letter& letter, bool several_lines) {
  if (several_lines && (letter.code == '\n' || letter.code == '\t')) return letter.valid;
  const bool control = letter.code < 0x20 || (letter.code >= 0x7F && letter.code < 0xA0);
  const bool line_break = letter.code == 0x2028 || letter.code == 0x2029;
  return letter.valid && !control && !line_break && !turns_direction(letter.code);
}

}  // namespace

bool is_valid_utf8(std::string_view text) {
  for (; !text.empty(); text.remove_prefix(first_letter(text).length))
    if (!first_letter(text).valid) return false;
  return true;
}

bool is_visible(std::string_view text, bool several_lines) {
  for (; !text.empty(); text.remove_prefix(first_letter(text).length))
    if (!is_harmless(first_letter(text), several_lines)) return false;
  return true;
}

std::string visible(std::string_view text, bool several_lines) {
  if (is_visible(text, several_lines)) return std::string(text);
  std::string result;
  for (; !text.empty(); text.remove_prefix(first_letter(text).length)) {
    const Letter letter = first_letter(text);
    if (is_harmless(letter, several_lines)) {
      result.append(text.substr(0, letter.length));
      continue;
    }
    for (const char byte : text.substr(0, letter.length))
      result += text::format("\\x{:02X}", static_cast<unsigned char>(byte));
  }
  return result;
}

std::string shell_word(std::string_view text) {
  constexpr std::string_view kHarmless = "-_./:+,@%=";
  const auto harmless = [&](char letter) {
    return std::isalnum(static_cast<unsigned char>(letter)) != 0 || kHarmless.find(letter) != std::string_view::npos;
  };
  if (!text.empty() && std::ranges::all_of(text, harmless)) return std::string(text);
  std::string word = "'";
  for (const char letter : visible(text, false)) word += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
  return word + "'";
}

}  // namespace sealwatch

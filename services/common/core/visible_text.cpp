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

/// Unicode 15: White_Space, Cc, Cf and Default_Ignorable_Code_Point, and the empty Braille pattern.
constexpr std::array<std::array<std::uint32_t, 2>, 30> kBlanks = {
    {{0x0, 0x20},        {0x7F, 0xA0},       {0xAD, 0xAD},       {0x34F, 0x34F},     {0x600, 0x605},
     {0x61C, 0x61C},     {0x6DD, 0x6DD},     {0x70F, 0x70F},     {0x890, 0x891},     {0x8E2, 0x8E2},
     {0x115F, 0x1160},   {0x1680, 0x1680},   {0x17B4, 0x17B5},   {0x180B, 0x180F},   {0x2000, 0x200F},
     {0x2028, 0x202F},   {0x205F, 0x206F},   {0x2800, 0x2800},   {0x3000, 0x3000},   {0x3164, 0x3164},
     {0xFE00, 0xFE0F},   {0xFEFF, 0xFEFF},   {0xFFA0, 0xFFA0},   {0xFFF0, 0xFFFB},   {0x110BD, 0x110BD},
     {0x110CD, 0x110CD}, {0x13430, 0x1343F}, {0x1BCA0, 0x1BCA3}, {0x1D173, 0x1D17A}, {0xE0000, 0xE0FFF}}};

bool is_blank(const Letter& letter) {
  return letter.valid && std::ranges::any_of(kBlanks, [&](const auto& range) {
           return range[0] <= letter.code && letter.code <= range[1];
         });
}

bool is_white_space(std::uint32_t code) {
  return code == 0xA0 || code == 0x1680 || (code >= 0x2000 && code <= 0x200A) || code == 0x202F || code == 0x205F ||
         code == 0x3000;
}

/// Zero-width joiners and variation selectors are part of words in some scripts.
bool joins_letters(std::uint32_t code) {
  return code == 0x200C || code == 0x200D || (code >= 0xFE00 && code <= 0xFE0F) || (code >= 0xE0100 && code <= 0xE01EF);
}

bool is_harmless(const Letter& letter, bool several_lines) {
  if (!letter.valid || !is_blank(letter) || letter.code == ' ') return letter.valid;
  const bool ends_line = letter.code == '\n' || letter.code == '\t';
  return several_lines && (ends_line || is_white_space(letter.code) || joins_letters(letter.code));
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

std::string without_blanks(std::string_view text) {
  std::string result;
  for (; !text.empty(); text.remove_prefix(first_letter(text).length))
    if (const Letter letter = first_letter(text); !is_blank(letter)) result.append(text.substr(0, letter.length));
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

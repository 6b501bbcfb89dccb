#include "services/common/message/base64.hpp"

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

namespace sealwatch {
namespace {

static_assert(std::endian::native == std::endian::little, "the exact form stores little-endian doubles");

constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

constexpr std::uint32_t kNone = 64;

/// By letter; kNone for those that mean nothing.
constexpr std::array<std::uint32_t, 256> kDigits = [] {
  std::array<std::uint32_t, 256> digits{};
  digits.fill(kNone);
  for (std::size_t k = 0; k < kAlphabet.size(); ++k)
    digits[static_cast<unsigned char>(kAlphabet[k])] = static_cast<std::uint32_t>(k);
  return digits;
}();

std::uint32_t digit_of(char letter) { return kDigits[static_cast<unsigned char>(letter)]; }

}  // namespace

void append_base64(std::string_view bytes, std::string& text) {
  const auto at = [bytes](std::size_t k) {
    return k < bytes.size() ? std::uint32_t{static_cast<unsigned char>(bytes[k])} : 0;
  };
  const std::size_t begin = text.size();
  text.resize(begin + (bytes.size() + 2) / 3 * 4);
  char* to = text.data() + begin;
  for (std::size_t k = 0; k < bytes.size(); k += 3, to += 4) {
    const std::uint32_t group = at(k) << 16U | at(k + 1) << 8U | at(k + 2);
    for (unsigned c = 0; c < 4; ++c) to[c] = kAlphabet[group >> (18U - 6U * c) & 63U];
  }
  for (std::size_t filler = (3 - bytes.size() % 3) % 3; filler != 0; --filler) *(to - filler) = '=';
}

void append_base64(const std::vector<double>& values, std::string& text) {
  append_base64({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double)}, text);
}

bool from_base64(std::string_view text, std::string& bytes) {
  text = text.substr(0, text.find('='));
  bytes.resize((text.size() + 3) / 4 * 3);
  char* to = bytes.data();
  std::uint32_t all = 0;
  for (std::size_t k = 0; k < text.size(); k += 4, to += 3) {
    std::uint32_t group = 0;
    for (std::size_t c = k; c < k + 4; ++c) {
      const std::uint32_t digit = c < text.size() ? digit_of(text[c]) : 0;
      all |= digit;
      group = group << 6U | digit;
    }
    to[0] = static_cast<char>(group >> 16U);
    to[1] = static_cast<char>(group >> 8U);
    to[2] = static_cast<char>(group);
  }
  bytes.resize(text.size() / 4 * 3 + text.size() % 4 * 3 / 4);
  return (all & kNone) == 0;
}

bool from_base64(std::string_view text, std::vector<double>& values) {
  std::string bytes;
  if (!from_base64(text, bytes) || bytes.size() % sizeof(double) != 0) return false;
  values.resize(bytes.size() / sizeof(double));
  if (!bytes.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
  return true;
}

}  // namespace sealwatch

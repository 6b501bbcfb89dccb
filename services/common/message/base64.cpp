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

void append_base64(const std::vector<double>& values, std::string& text) {
  const std::size_t size = values.size() * sizeof(double);
  std::vector<unsigned char> bytes(size + 2);  // and what fills the last group
  if (size != 0) std::memcpy(bytes.data(), values.data(), size);
  const std::size_t begin = text.size();
  text.resize(begin + (size + 2) / 3 * 4);
  char* to = text.data() + begin;
  for (std::size_t k = 0; k < size; k += 3, to += 4) {
    const std::uint32_t group = std::uint32_t{bytes[k]} << 16U | std::uint32_t{bytes[k + 1]} << 8U | bytes[k + 2];
    for (unsigned c = 0; c < 4; ++c) to[c] = kAlphabet[group >> (18U - 6U * c) & 63U];
  }
  for (std::size_t filler = (3 - size % 3) % 3; filler != 0; --filler) *(to - filler) = '=';
}

bool from_base64(std::string_view text, std::vector<double>& values) {
  text = text.substr(0, text.find('='));
  const std::size_t size = text.size() / 4 * 3 + text.size() % 4 * 3 / 4;
  if (size % sizeof(double) != 0) return false;
  std::vector<unsigned char> bytes((text.size() + 3) / 4 * 3);
  unsigned char* to = bytes.data();
  std::uint32_t all = 0;
  for (std::size_t k = 0; k < text.size(); k += 4, to += 3) {
    std::uint32_t group = 0;
    for (std::size_t c = k; c < k + 4; ++c) {
      const std::uint32_t digit = c < text.size() ? digit_of(text[c]) : 0;
      all |= digit;
      group = group << 6U | digit;
    }
    to[0] = static_cast<unsigned char>(group >> 16U);
    to[1] = static_cast<unsigned char>(group >> 8U);
    to[2] = static_cast<unsigned char>(group);
  }
  if ((all & kNone) != 0) return false;
  values.resize(size / sizeof(double));
  if (size != 0) std::memcpy(values.data(), bytes.data(), size);
  return true;
}

}  // namespace sealwatch

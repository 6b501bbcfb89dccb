#include "services/common/recording/text_file.hpp"

#include <array>
#include <cstdint>
#include <sstream>

#include "sealwatch/core/file.hpp"
#include "services/common/recording/columns.hpp"
#include "services/common/recording/recording_file.hpp"

namespace sealwatch {
namespace {

constexpr std::string_view kLittleEndian = "\xFF\xFE", kBigEndian = "\xFE\xFF";

void append_utf8(std::uint32_t point, std::string& out) {
  const auto tail = [&](unsigned shift) { out += static_cast<char>(0x80U | ((point >> shift) & 0x3FU)); };
  if (point < 0x80U) {
    out += static_cast<char>(point);
  } else if (point < 0x800U) {
    out += static_cast<char>(0xC0U | (point >> 6U));
    tail(0);
  } else if (point < 0x10000U) {
    out += static_cast<char>(0xE0U | (point >> 12U));
    tail(6), tail(0);
  } else {
    out += static_cast<char>(0xF0U | (point >> 18U));
    tail(12), tail(6), tail(0);
  }
}

}  // namespace

Result<std::string> utf8_of_utf16(std::string_view text) {
  const bool little = text.starts_with(kLittleEndian);
  const auto unit = [&](std::size_t at) {
    const auto first = static_cast<unsigned char>(text[at]), second = static_cast<unsigned char>(text[at + 1]);
    return static_cast<std::uint32_t>(little ? first | (second << 8U) : (first << 8U) | second);
  };
  const auto broken = [](std::size_t at) {
    return fail(error_at("byte " + std::to_string(at + 1), {}, "is no UTF-16, as the file's first two bytes say it is",
                         "save it as UTF-8"));
  };
  std::string out;
  out.reserve(text.size() / 2);
  for (std::size_t at = 2; at < text.size(); at += 2) {
    if (at + 1 == text.size()) return broken(at);
    std::uint32_t point = unit(at);
    if (point >= 0xDC00U && point < 0xE000U) return broken(at);
    if (point >= 0xD800U && point < 0xDC00U) {  // the first of a pair
      const std::uint32_t second = at + 3 < text.size() ? unit(at + 2) : 0;
      if (second < 0xDC00U || second >= 0xE000U) return broken(at);
      point = 0x10000U + ((point - 0xD800U) << 10U) + (second - 0xDC00U);
      at += 2;
    }
    append_utf8(point, out);
  }
  return out;
}

Result<std::unique_ptr<std::istream>> open_text(const std::string& path) {
  Result<std::ifstream> in = open_file(path, kLargestRecording_bytes);
  if (!in) return fail(in.error());
  std::array<char, 2> mark{};
  in->read(mark.data(), mark.size());
  const std::string_view begin(mark.data(), static_cast<std::size_t>(in->gcount()));
  if (begin != kLittleEndian && begin != kBigEndian) {
    in->clear();
    in->seekg(0);
    return std::make_unique<std::ifstream>(std::move(*in));
  }
  const Result<std::string> text = read_file(path, kLargestRecording_bytes);
  if (!text) return fail(text.error());
  Result<std::string> converted = utf8_of_utf16(*text);
  if (!converted) return fail(converted.error());
  return std::make_unique<std::istringstream>(std::move(*converted));
}

}  // namespace sealwatch

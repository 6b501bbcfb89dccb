#include "sealwatch/core/result.hpp"

namespace sealwatch {

namespace {

constexpr std::size_t kLongestValue = 200;  // bytes: a file taken for a setting would fill the screen

std::string brief(std::string value) {
  if (value.size() <= kLongestValue) return value;
  std::size_t end = kLongestValue;
  while (end > 0 && (static_cast<unsigned char>(value[end]) & 0xC0U) == 0x80U) --end;  // no half letter
  value.resize(end);
  return value.append("…");
}

}  // namespace

std::string Error::describe() const {
  std::string text;
  const auto add = [&text](const std::string& part, const char* separator) {
    if (part.empty()) return;
    if (!text.empty()) text += separator;
    text += part;
  };
  add(file, "");
  add(place, ": ");
  if (!value.empty()) add(std::string("'").append(brief(value)).append("'"), ": ");
  add(rule, ": ");
  add(advice, "; ");
  return text;
}

}  // namespace sealwatch

#include "sealwatch/core/result.hpp"

namespace sealwatch {

std::string Error::describe() const {
  std::string text;
  const auto add = [&text](const std::string& part, const char* separator) {
    if (part.empty()) return;
    if (!text.empty()) text += separator;
    text += part;
  };
  add(file, "");
  add(place, ": ");
  if (!value.empty()) add("'" + value + "'", ": ");
  add(rule, ": ");
  add(advice, "; ");
  return text;
}

}  // namespace sealwatch

#include "services/common/text/words.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

namespace sealwatch::text {
namespace {

/// Names of people, and compounds, that an identifier cannot spell.
constexpr std::array<std::pair<std::string_view, std::string_view>, 7> kSpellings = {{{"coulomb", "Coulomb"},
                                                                                      {"stribeck", "Stribeck"},
                                                                                      {"dahl", "Dahl"},
                                                                                      {"lugre", "LuGre"},
                                                                                      {"froehlich", "Froehlich"},
                                                                                      {" dependent", "-dependent"},
                                                                                      {"warm up", "warm-up"}}};

}  // namespace

std::string in_words(std::string_view identifier) {
  if (identifier == "unlisted") return "unlisted physics";  // the id of what no law of the list describes
  std::string text;
  bool symbol = false;  // "y_w", "R_CL": one letter with an index
  for (std::size_t k = 0; k < identifier.size(); ++k) {
    if (k == 0 || identifier[k - 1] == ':') symbol = identifier.substr(k + 1).starts_with('_');
    if (identifier[k] == '_')
      text += symbol ? '_' : ' ';
    else if (identifier[k] == ':')
      text += ": ";
    else
      text += identifier[k];
  }
  if (!symbol && (identifier.ends_with("_a") || identifier.ends_with("_b")))  // "pressure A", "chamber B"
    text.back() = static_cast<char>(std::toupper(static_cast<unsigned char>(text.back())));
  for (const auto& [plain, written] : kSpellings)
    if (const std::size_t at = text.find(plain); at != std::string::npos) text.replace(at, plain.size(), written);
  return text;
}

std::string joined(const std::vector<std::string>& parts, std::string_view last) {
  std::string text;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    if (k > 0) text.append(k + 1 == parts.size() ? last : ", ");
    text += parts[k];
  }
  return text;
}

std::string separated(const std::vector<std::string>& parts, std::string_view between) {
  std::string text;
  for (const std::string& part : parts) text.append(&part == parts.data() ? "" : between).append(part);
  return text;
}

void add_to_list(std::string& text, std::string_view part, std::string_view between) {
  text.append(text.empty() ? "" : between).append(part);
}

std::string count_of(std::size_t count, std::string_view thing) {
  std::string text = std::to_string(count);
  text.append(" ").append(thing);
  return count == 1 ? text : text.append("s");
}

std::string quoted(std::string_view text) {
  std::string result = "\"";
  for (const char letter : text) {
    if (letter == '"' || letter == '\\') result += '\\';
    result += static_cast<unsigned char>(letter) < 0x20 ? ' ' : letter;
  }
  return result + "\"";
}

std::size_t letters(std::string_view text) {
  return static_cast<std::size_t>(
      std::ranges::count_if(text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

std::string padded(std::string_view text, std::size_t width) {
  std::string result(text);
  const std::size_t length = letters(text);
  if (length < width) result.append(width - length, ' ');
  return result;
}

std::size_t end_of_word(std::string_view text) {
  std::size_t end = text.find(' ');
  while (end != text.npos && text.substr(end + 1).starts_with('%')) end = text.find(' ', end + 1);
  return std::min(end, text.size());
}

std::string wrapped(std::string_view text, std::size_t width, std::size_t indent) {
  std::string result;
  std::size_t column = indent;
  while (!text.empty()) {
    const std::size_t end = end_of_word(text);
    if (column > indent && column + 1 + end > width) {
      result += '\n';
      result.append(indent, ' ');
      column = indent;
    } else if (column > indent) {
      result += ' ';
      ++column;
    }
    result += text.substr(0, end);
    column += end;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return result;
}

}  // namespace sealwatch::text

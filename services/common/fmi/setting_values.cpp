#include "services/common/fmi/setting_values.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <limits>
#include <sstream>

#include "services/common/text/format.hpp"
#include "services/common/text/numbers.hpp"

namespace sealwatch::fmi {
namespace {

struct Range {
  double least = -std::numeric_limits<double>::infinity(), most = std::numeric_limits<double>::infinity();
};

template <class T>
constexpr Range range_of_type() {
  return {static_cast<double>(std::numeric_limits<T>::min()), static_cast<double>(std::numeric_limits<T>::max())};
}

/// What the type can hold, and the description allows.
Range range_of(const Variable& variable) {
  Range range;
  if (variable.type == FmiType::int8) range = range_of_type<std::int8_t>();
  if (variable.type == FmiType::uint8) range = range_of_type<std::uint8_t>();
  if (variable.type == FmiType::int16) range = range_of_type<std::int16_t>();
  if (variable.type == FmiType::uint16) range = range_of_type<std::uint16_t>();
  if (variable.type == FmiType::int32) range = range_of_type<std::int32_t>();
  if (variable.type == FmiType::uint32) range = range_of_type<std::uint32_t>();
  if (variable.type == FmiType::uint64) range.least = 0.0;
  if (variable.min) range.least = std::max(range.least, *variable.min);
  if (variable.max) range.most = std::min(range.most, *variable.max);
  return range;
}

bool is_real(FmiType type) { return type == FmiType::float64 || type == FmiType::float32; }

std::optional<double> number_in(const std::string& word) {
  if (word == "true") return 1.0;
  if (word == "false") return 0.0;
  char* end = nullptr;
  const double value = std::strtod(word.c_str(), &end);
  return word.empty() || *end != '\0' ? std::nullopt : std::optional(value);
}

std::optional<double> value_of_word(const Variable& variable, const std::string& word) {
  if (const auto number = number_in(word)) return number;
  const auto item = std::ranges::find(variable.items, word, &Item::name);
  return item == variable.items.end() ? std::nullopt : std::optional(item->value);
}

/// "its items are free (1), stiff (2)"
std::string items_in_words(const Variable& variable) {
  std::string words;
  for (const Item& item : variable.items)
    words += (words.empty() ? "its items are " : ", ") + item.name + " (" + text::exact(item.value) + ")";
  return words;
}

/// "" where the variable can have the value.
std::string fault_of(const Variable& variable, double value) {
  const Range range = range_of(variable);
  if (!std::isfinite(value)) return "must be finite";
  if (variable.type == FmiType::boolean) return value == 0.0 || value == 1.0 ? "" : "must be true or false";
  if (!is_real(variable.type) && value != std::round(value))
    return "must be a whole number, as " + variable.name + " is of type " + std::string(name_of(variable.type));
  const bool is_item = std::ranges::find(variable.items, value, &Item::value) != variable.items.end();
  if (!variable.items.empty()) return is_item ? "" : "is not an item of the enumeration " + variable.name;
  if (value < range.least) return "must be " + text::exact(range.least) + " or more, as the FMU declares it";
  if (value > range.most) return "must be " + text::exact(range.most) + " or less, as the FMU declares it";
  return "";
}

/// The words of an array; an item's name may have spaces in it.
std::vector<std::string> words_of(const Variable& variable, const std::string& text) {
  if (std::ranges::find(variable.items, text, &Item::name) != variable.items.end()) return {text};
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
}

tl::unexpected<Error> refused(const std::string& value, std::string rule, std::string advice) {
  return fail(Error{.file = {}, .place = {}, .value = value, .rule = std::move(rule), .advice = std::move(advice)});
}

}  // namespace

Result<std::string> value_of_setting(const Variable& variable, const std::string& text) {
  if (text.find('\0') != std::string::npos)
    return refused(variable.name, "has a zero byte in its value", "a text ends at one");
  if (variable.type == FmiType::string) return text;
  const std::vector<std::string> words = words_of(variable, text);
  const bool whole = !is_real(variable.type) && variable.type != FmiType::boolean;
  std::string result;
  for (const std::string& word : words) {
    const std::optional<double> value = value_of_word(variable, word);
    if (!value && !variable.items.empty())
      return refused(word, "is not an item of the enumeration " + variable.name, items_in_words(variable));
    if (!value) break;
    if (std::string fault = fault_of(variable, *value); !fault.empty())
      return refused(word, std::move(fault), items_in_words(variable));
    result += (result.empty() ? "" : " ") + (whole ? text::format("{:.0f}", *value) : word);
  }
  const bool all = std::ranges::all_of(words, [&](const std::string& word) { return !!value_of_word(variable, word); });
  if (all && words.size() == variable.size) return result;
  return refused(text,
                 "must have as many numbers as " + variable.name + " has elements, " + std::to_string(variable.size),
                 "true and false count as numbers");
}

}  // namespace sealwatch::fmi

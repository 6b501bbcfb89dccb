// Reads what to_json wrote, letter by letter into the struct. No document tree: a start reads the history of years.
//
// It takes members in the order of their fields, some of which may be absent, without blanks between them. Of any other
// text it says that it cannot read it, and the reader of all JSON (json.cpp) is asked, which also says what is wrong;
// what both read, they read alike.
#pragma once

#include <charconv>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "sealwatch/core/fields.hpp"
#include "services/common/message/base64.hpp"

namespace sealwatch {

/// Any JSON string in its quotes (json.cpp).
[[nodiscard]] bool is_string_read_into(std::string_view quoted, std::string& text);

class OwnJson {
 public:
  explicit OwnJson(std::string_view text) : at_(text.data()), end_(text.data() + text.size()) {}

  /// Whether the text is one value of this kind and nothing else; if not, `value` is spoilt.
  template <class T>
  [[nodiscard]] bool is_read_into(T& value) {
    return read(value) && at_ == end_;
  }

 private:
  /// Reads each visited field where the next member has its name.
  struct Members {
    OwnJson& json;
    bool is_good = true;
    bool is_first = true;
    template <class T>
    void operator()(std::string_view name, T& value) {
      if (!is_good || !json.takes_name(name, is_first)) return;
      is_first = false;
      is_good = json.read(value);
    }
  };

  template <class T>
  [[nodiscard]] bool read(T& value) {
    if constexpr (Described<T>) {
      if (!takes('{')) return false;
      Members members{*this};
      T::visit(members, value);
      return members.is_good && takes('}');
    } else if constexpr (std::is_enum_v<T>) {
      std::string_view name;
      const auto known = takes_string(name) ? value_of<T>(name) : std::nullopt;
      if (known) value = *known;
      return known.has_value();
    } else if constexpr (std::is_same_v<T, std::string>) {
      return read_text(value);
    } else if constexpr (std::is_same_v<T, bool>) {
      value = at_ != end_ && *at_ == 't';
      return takes(value ? std::string_view("true") : std::string_view("false"));
    } else if constexpr (std::is_same_v<T, double>) {
      return read_number(value);
    } else if constexpr (std::is_integral_v<T>) {
      const std::string_view digits = number();
      return is_whole(digits) && is_all_of(digits, value);
    } else {
      return read_list(value);
    }
  }

  template <class T>
  [[nodiscard]] bool read_list(std::vector<T>& values) {
    if constexpr (std::is_same_v<T, double>) {
      std::string_view base64;
      if (at_ != end_ && *at_ == '"') return takes_string(base64) && from_base64(base64, values);
    }
    values.clear();
    if (!takes('[')) return false;
    if (takes(']')) return true;
    do {
      if (!read(values.emplace_back())) return false;
    } while (takes(','));
    return takes(']');
  }

  [[nodiscard]] bool read_number(double& value) {
    if (at_ != end_ && (*at_ == '"' || *at_ == 'n')) return read_no_number(value);
    const std::string_view digits = number();
    return digits != "-0" && is_json_number(digits) && is_all_of(digits, value);
  }

  [[nodiscard]] bool read_text(std::string& value) {
    const char* const begin = at_;
    std::string_view text;
    if (takes_string(text)) {
      value = text;
      return true;
    }
    at_ = begin;
    if (!takes('"')) return false;
    while (at_ != end_ && *at_ != '"') at_ += *at_ == '\\' && at_ + 1 != end_ ? 2 : 1;
    return takes('"') && is_string_read_into({begin, at_}, value);
  }

  /// What stands in the place of a number that is none.
  [[nodiscard]] bool read_no_number(double& value) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    if (takes("null") || takes("\"nan\""))
      value = std::numeric_limits<double>::quiet_NaN();
    else if (takes("\"inf\""))
      value = kInfinity;
    else if (takes("\"-inf\""))
      value = -kInfinity;
    else
      return false;
    return true;
  }

  [[nodiscard]] bool takes(char letter) {
    if (at_ == end_ || *at_ != letter) return false;
    ++at_;
    return true;
  }

  [[nodiscard]] bool takes(std::string_view letters) {
    if (!std::string_view(at_, end_).starts_with(letters)) return false;
    at_ += letters.size();
    return true;
  }

  /// The next member's name with what stands before and behind it, or nothing.
  [[nodiscard]] bool takes_name(std::string_view name, bool is_first) {
    const char* const before = at_;
    if ((is_first || takes(',')) && takes('"') && takes(name) && takes("\":")) return true;
    at_ = before;
    return false;
  }

  /// One in which nothing is escaped, of ASCII letters.
  [[nodiscard]] bool takes_string(std::string_view& text) {
    if (!takes('"')) return false;
    const char* const begin = at_;
    while (at_ != end_ && *at_ >= ' ' && *at_ < '\x7f' && *at_ != '"' && *at_ != '\\') ++at_;
    text = {begin, at_};
    return takes('"');
  }

  [[nodiscard]] std::string_view number() {
    const char* const begin = at_;
    while (at_ != end_ && ((*at_ >= '0' && *at_ <= '9') || *at_ == '-' || *at_ == '+' || *at_ == '.' || *at_ == 'e'))
      ++at_;
    return {begin, at_};
  }

  [[nodiscard]] static bool is_digit(char letter) { return letter >= '0' && letter <= '9'; }

  [[nodiscard]] static bool is_whole(std::string_view digits) {
    if (digits.starts_with('-')) digits.remove_prefix(1);
    if (digits.empty() || (digits.front() == '0' && digits.size() > 1)) return false;
    for (const char letter : digits)
      if (!is_digit(letter)) return false;
    return true;
  }

  /// As JSON has it: from_chars takes 01, 1. and .5, too.
  [[nodiscard]] static bool is_json_number(std::string_view digits) {
    const std::size_t whole = digits.find_first_of(".e");
    if (!is_whole(digits.substr(0, whole))) return false;
    if (whole == std::string_view::npos || digits[whole] == 'e') return true;
    return whole + 1 < digits.size() && is_digit(digits[whole + 1]);
  }

  template <class Number>
  [[nodiscard]] static bool is_all_of(std::string_view digits, Number& value) {
    const auto read = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    return read.ec == std::errc{} && read.ptr == digits.data() + digits.size();
  }

  const char* at_;
  const char* end_;
};

}  // namespace sealwatch

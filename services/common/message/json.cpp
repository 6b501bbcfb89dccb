#include "services/common/message/json.hpp"
#include "sealwatch/core/json_depth.hpp"
#include "sealwatch/message/blank.hpp"
#include "services/common/message/base64.hpp"
#include "services/common/message/own_json.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <type_traits>
#include <utility>

namespace sealwatch {
namespace {

using Json = nlohmann::ordered_json;

bool is_plain(char c) { return c >= ' ' && c < '\x7f' && c != '"' && c != '\\'; }

/// Writes values at the end of a text. No document tree: a service journals a thousand blocks of samples a second.
class Writer {
 public:
  Writer(std::string& text, JsonForm form) : text_(text), form_(form) {}

  template <class T>
  void write(const T& value) {
    if constexpr (Described<T>) {
      Members members{*this};
      text_ += '{';
      T::visit(members, value);
      text_ += '}';
    } else if constexpr (std::is_enum_v<T>) {
      write_string(name_of(value));
    } else if constexpr (std::is_same_v<T, std::string>) {
      write_string(value);
    } else if constexpr (std::is_same_v<T, double>) {
      write_number(value);
    } else if constexpr (std::is_same_v<T, bool>) {
      text_ += value ? "true" : "false";
    } else if constexpr (std::is_integral_v<T>) {
      text_ += std::to_string(value);
    } else {
      write_list(value);
    }
  }

 private:
  /// Writes each visited field as a member of the object.
  struct Members {
    Writer& writer;
    bool first = true;
    template <class T>
    void operator()(std::string_view name, const T& value) {
      if (!std::exchange(first, false)) writer.text_ += ',';
      writer.text_ += '"';
      writer.text_ += name;
      writer.text_ += "\":";
      writer.write(value);
    }
  };

  template <class T>
  void write_list(const std::vector<T>& values) {
    if constexpr (std::is_same_v<T, double>) {
      if (form_ == JsonForm::exact) {
        text_ += '"';
        append_base64(values, text_);
        text_ += '"';
        return;
      }
    }
    text_ += '[';
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (k != 0) text_ += ',';
      write(values[k]);
    }
    text_ += ']';
  }

  /// What needs no escape is copied; the rest is left to the library. What is no UTF-8 comes out as U+FFFD.
  void write_string(std::string_view value) {
    if (std::ranges::all_of(value, is_plain)) {
      text_ += '"';
      text_ += value;
      text_ += '"';
    } else {
      text_ += Json(value).dump(-1, ' ', false, Json::error_handler_t::replace);
    }
  }

  void write_number(double value) {
    if (std::isfinite(value))
      text_ += Json(value).dump();
    else if (form_ == JsonForm::readable)
      text_ += "null";
    else
      text_ += std::isnan(value) ? "\"nan\"" : value > 0 ? "\"inf\"" : "\"-inf\"";
  }

  std::string& text_;
  JsonForm form_;
};

template <class T>
std::string write_json(const T& value, JsonForm form) {
  std::string text;
  Writer(text, form).write(value);
  return text;
}

/// Where a message's text departs from its layout.
struct LayoutError {
  std::string field;
  std::string rule;
};

template <class T>
void decode(const Json& json, const std::string& place, T& value);

/// Fills each visited field from the object's member of the same name, if it is there.
struct Decoder {
  const Json& object;
  const std::string& place;
  template <class T>
  void operator()(std::string_view name, T& value) const {
    const auto member = object.find(std::string(name));
    if (member == object.end()) return;
    decode(*member, place.empty() ? std::string(name) : place + "." + std::string(name), value);
  }
};

void decode_number(const Json& json, const std::string& place, double& value) {
  if (json.is_number()) {
    value = json.get<double>();
  } else if (json.is_null() || json == "nan") {
    value = std::numeric_limits<double>::quiet_NaN();
  } else if (json == "inf" || json == "-inf") {
    value = json == "inf" ? std::numeric_limits<double>::infinity() : -std::numeric_limits<double>::infinity();
  } else {
    throw LayoutError{place, "must be a number"};
  }
}

/// One that its type can hold; 3.0 is whole, too.
template <class Whole>
void decode_whole(const Json& json, const std::string& place, Whole& value) {
  constexpr double kExact = 9007199254740992.0;  // 2^53: up to there doubles hold all whole numbers
  if (!json.is_number()) throw LayoutError{place, "has the wrong type"};
  const double number = json.get<double>();
  const bool whole = !json.is_number_float() || (std::abs(number) <= kExact && number == std::floor(number));
  if (whole && json.is_number_unsigned() && std::in_range<Whole>(json.get<std::uint64_t>()))
    value = static_cast<Whole>(json.get<std::uint64_t>());
  else if (whole && !json.is_number_unsigned() && std::in_range<Whole>(json.get<std::int64_t>()))
    value = static_cast<Whole>(json.get<std::int64_t>());
  else
    throw LayoutError{place, "must be a whole number that fits"};
}

template <class T>
void decode(const Json& json, const std::string& place, T& value) {
  if constexpr (Described<T>) {
    if (!json.is_object()) throw LayoutError{place, "must be an object"};
    T::visit(Decoder{json, place}, value);
  } else if constexpr (std::is_enum_v<T>) {
    const auto known = json.is_string() ? value_of<T>(json.get<std::string>()) : std::nullopt;
    if (!known) throw LayoutError{place, "must be one of the enumeration's names"};
    value = *known;
  } else if constexpr (std::is_same_v<T, double>) {
    decode_number(json, place, value);
  } else if constexpr (std::is_integral_v<T> && !std::is_same_v<T, bool>) {
    decode_whole(json, place, value);
  } else if constexpr (requires { typename T::value_type; } && !std::is_same_v<T, std::string>) {
    if constexpr (std::is_same_v<T, std::vector<double>>) {
      if (json.is_string()) {
        if (!from_base64(json.get<std::string>(), value)) throw LayoutError{place, "must be base64 of doubles"};
        return;
      }
    }
    if (!json.is_array()) throw LayoutError{place, "must be an array"};
    value.clear();
    for (const Json& item : json) {
      value.emplace_back();
      decode(item, place + "[" + std::to_string(value.size() - 1) + "]", value.back());
    }
  } else {
    try {
      value = json.get<T>();
    } catch (const nlohmann::json::exception&) {
      throw LayoutError{place, "has the wrong type"};
    }
  }
}

}  // namespace

std::string to_json(const Message& message, JsonForm form) {
  return std::visit([form](const auto& m) { return write_json(m, form); }, message);
}

std::string to_json(const ServiceStatus& status) { return write_json(status, JsonForm::readable); }

std::string to_json(const AlarmEntry& entry) { return write_json(entry, JsonForm::readable); }

Result<AlarmEntry> alarm_from_json(std::string_view text) {
  AlarmEntry entry;
  try {
    if (is_nested_too_deeply(text)) throw LayoutError{{}, kNestedTooDeeply};
    const Json json = Json::parse(text, nullptr, false);
    if (json.is_discarded()) throw LayoutError{{}, "is not JSON"};
    decode(json, {}, entry);
  } catch (const LayoutError& error) {
    return fail(Error{.file = "alarm", .place = error.field, .value = {}, .rule = error.rule, .advice = {}});
  }
  return entry;
}

bool is_string_read_into(std::string_view quoted, std::string& text) {
  const Json json = Json::parse(quoted, nullptr, false);
  if (!json.is_string()) return false;
  text = json.get<std::string>();
  return true;
}

Result<Message> message_from_json(Topic topic, std::string_view text) {
  const auto wrong = [topic](std::string place, std::string rule) {
    return fail(Error{.file = "message of topic " + std::string(name_of(topic)),
                      .place = std::move(place),
                      .value = {},
                      .rule = std::move(rule),
                      .advice = {}});
  };
  Message message = blank_message(topic);
  if (std::visit([text](auto& m) { return OwnJson(text).is_read_into(m); }, message)) return message;
  if (is_nested_too_deeply(text)) return wrong({}, kNestedTooDeeply);
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) return wrong({}, "is not JSON");
  message = blank_message(topic);
  try {
    std::visit([&json](auto& m) { decode(json, {}, m); }, message);
  } catch (const LayoutError& error) {
    return wrong(error.field, error.rule);
  }
  return message;
}

}  // namespace sealwatch

#include "services/common/message/json.hpp"

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <type_traits>

namespace sealwatch {
namespace {

using Json = nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little, "the exact form stores little-endian doubles");

constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

std::string to_base64(const std::vector<double>& values) {
  const std::size_t size = values.size() * sizeof(double);
  std::string bytes(size, '\0');
  if (size != 0) std::memcpy(bytes.data(), values.data(), size);
  std::string text;
  text.reserve((size + 2) / 3 * 4);
  for (std::size_t k = 0; k < size; k += 3) {
    std::uint32_t group = 0;
    for (std::size_t b = 0; b < 3; ++b)
      group = group << 8U | (k + b < size ? static_cast<unsigned char>(bytes[k + b]) : 0U);
    for (std::size_t c = 0; c < 4; ++c) text += k + c > size ? '=' : kAlphabet[group >> (18 - 6 * c) & 63U];
  }
  return text;
}

bool from_base64(const std::string& text, std::vector<double>& values) {
  static const auto decode = [] {
    std::array<int, 256> table{};
    table.fill(-1);
    for (std::size_t k = 0; k < kAlphabet.size(); ++k)
      table[static_cast<unsigned char>(kAlphabet[k])] = static_cast<int>(k);
    return table;
  }();
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3);
  std::uint32_t group = 0;
  int bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    const int digit = decode[static_cast<unsigned char>(c)];
    if (digit < 0) return false;
    group = group << 6U | static_cast<std::uint32_t>(digit);
    bits += 6;
    if (bits >= 8) {
      bits -= 8;
      bytes += static_cast<char>(group >> static_cast<unsigned>(bits) & 255U);
    }
  }
  if (bytes.size() % sizeof(double) != 0) return false;
  values.resize(bytes.size() / sizeof(double));
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
  return true;
}

template <class T>
Json encode(const T& value, JsonForm form);

/// Turns each visited field into a member of a JSON object.
struct Encoder {
  Json& object;
  JsonForm form;
  template <class T>
  void operator()(std::string_view name, const T& value) const {
    object[std::string(name)] = encode(value, form);
  }
};

Json encode_number(double value, JsonForm form) {
  if (std::isfinite(value)) return value;
  if (form == JsonForm::readable) return nullptr;
  return std::isnan(value) ? "nan" : value > 0 ? "inf" : "-inf";
}

template <class T>
Json encode(const T& value, JsonForm form) {
  if constexpr (Described<T>) {
    Json object = Json::object();
    T::visit(Encoder{object, form}, value);
    return object;
  } else if constexpr (std::is_enum_v<T>) {
    return std::string(name_of(value));
  } else if constexpr (std::is_same_v<T, double>) {
    return encode_number(value, form);
  } else if constexpr (std::is_same_v<T, std::vector<double>>) {
    if (form == JsonForm::exact) return to_base64(value);
    Json array = Json::array();
    for (const double number : value) array.push_back(encode_number(number, form));
    return array;
  } else if constexpr (requires { typename T::value_type; } && !std::is_same_v<T, std::string>) {
    Json array = Json::array();
    for (const auto& item : value) array.push_back(encode(item, form));
    return array;
  } else {
    return value;
  }
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

template <std::size_t index = 0>
Message blank(Topic topic) {
  if constexpr (index + 1 < std::variant_size_v<Message>) {
    if (static_cast<std::size_t>(topic) != index) return blank<index + 1>(topic);
  }
  return Message(std::in_place_index<index>);
}

}  // namespace

std::string to_json(const Message& message, JsonForm form) {
  return std::visit([form](const auto& m) { return encode(m, form).dump(); }, message);
}

std::string to_json(const ServiceStatus& status) { return encode(status, JsonForm::readable).dump(); }

Result<Message> message_from_json(Topic topic, std::string_view text) {
  const Json json = Json::parse(text, nullptr, false);
  const auto wrong = [topic](std::string place, std::string rule) {
    return fail(Error{.file = "message of topic " + std::string(name_of(topic)),
                      .place = std::move(place),
                      .value = {},
                      .rule = std::move(rule),
                      .advice = {}});
  };
  if (json.is_discarded()) return wrong({}, "is not JSON");
  Message message = blank(topic);
  try {
    std::visit([&json](auto& m) { decode(json, {}, m); }, message);
  } catch (const LayoutError& error) {
    return wrong(error.field, error.rule);
  }
  return message;
}

}  // namespace sealwatch

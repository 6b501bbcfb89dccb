// Messages in few bytes, for what is read often and can be made again from JSON: of each only what differs from an
// earlier one of its topic. The reports on an actuator's tests say much the same, month after month; a start reads years
// of them.
//
// A struct is one bit for each field, whether it differs, and then the fields that do; numbers are differences, texts
// what follows the common beginning, doubles their bits. Bytes of another layout of the structs (packed_layout) are not
// to be unpacked: they mean something else.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "sealwatch/core/fields.hpp"
#include "sealwatch/message/topics.hpp"

namespace sealwatch {

template <class T>
struct IsList : std::false_type {};
template <class T>
struct IsList<std::vector<T>> : std::true_type {};

/// Bit for bit, unlike ==, by which no NaN is the same and both zeros are.
template <class T>
[[nodiscard]] bool is_same_in_bits(const T& a, const T& b) {
  if constexpr (Described<T>) {
    bool same = true;
    T::visit_pair([&](std::string_view, const auto& x, const auto& y) { same = same && is_same_in_bits(x, y); }, a, b);
    return same;
  } else if constexpr (std::is_same_v<T, double>) {
    return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
  } else if constexpr (IsList<T>::value) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](const auto& x, const auto& y) { return is_same_in_bits(x, y); });
  } else {
    return a == b;
  }
}

/// Writes values at the end of some bytes.
class Packer {
 public:
  explicit Packer(std::string& bytes) : bytes_(bytes) {}

  /// `before`: what Unpacker::unpack is given.
  template <class T>
  void pack(const T& value, const T& before) {
    if constexpr (Described<T>) {
      pack_fields(value, before);
    } else if constexpr (std::is_same_v<T, std::string>) {
      const auto ends = std::mismatch(value.begin(), value.end(), before.begin(), before.end());
      const auto common = static_cast<std::size_t>(ends.first - value.begin());
      pack_number(common);
      pack_number(value.size() - common);
      bytes_.append(value, common);
    } else if constexpr (std::is_same_v<T, double>) {
      bytes_.append(reinterpret_cast<const char*>(&value), sizeof(value));
    } else if constexpr (IsList<T>::value) {
      pack_number(value.size());
      const typename T::value_type none{};
      for (std::size_t k = 0; k < value.size(); ++k) pack(value[k], k < before.size() ? before[k] : none);
    } else {
      const std::uint64_t more = static_cast<std::uint64_t>(value) - static_cast<std::uint64_t>(before);
      pack_number(more << 1U ^ (0 - (more >> 63U)));  // small for small differences of both signs
    }
  }

 private:
  template <class T>
  void pack_fields(const T& value, const T& before) {
    const std::size_t flags = bytes_.size();
    bytes_.append((T::kFieldCount + 7) / 8, '\0');
    std::size_t number = 0;
    const auto pack_field = [&](std::string_view, const auto& field, const auto& was) {
      const std::size_t k = number++;
      if (is_same_in_bits(field, was)) return;
      bytes_[flags + k / 8] = static_cast<char>(static_cast<unsigned char>(bytes_[flags + k / 8]) | 1U << k % 8);
      if constexpr (!std::is_same_v<std::decay_t<decltype(field)>, bool>) pack(field, was);
    };
    T::visit_pair(pack_field, value, before);
  }

  void pack_number(std::uint64_t number) {
    for (; number >= 0x80U; number >>= 7U) bytes_ += static_cast<char>(number | 0x80U);
    bytes_ += static_cast<char>(number);
  }

  std::string& bytes_;
};

/// Reads them again. Any bytes may come: what cannot be is refused. A value takes as much memory as the one before it and
/// what its own bytes may say.
class Unpacker {
 public:
  explicit Unpacker(std::string_view bytes) : bytes_(bytes) {}

  [[nodiscard]] bool is_at_end() const { return bytes_.empty(); }

  /// Whether there is one; `value` is what it was packed behind, and is spoilt if there is none.
  template <class T>
  [[nodiscard]] bool unpack(T& value) {
    if constexpr (Described<T>) {
      return unpack_fields(value);
    } else if constexpr (std::is_same_v<T, std::string>) {
      const auto common = number();
      const auto rest = number();
      if (!common || *common > value.size() || !rest || *rest > bytes_.size()) return false;
      value.resize(static_cast<std::size_t>(*common));
      value += taken(static_cast<std::size_t>(*rest));
      return true;
    } else if constexpr (std::is_same_v<T, double>) {
      if (bytes_.size() < sizeof(value)) return false;
      std::memcpy(&value, taken(sizeof(value)).data(), sizeof(value));
      return true;
    } else if constexpr (IsList<T>::value) {
      const auto size = number();
      if (!size || *size > bytes_.size()) return false;  // each takes a byte at least
      value.resize(static_cast<std::size_t>(*size));
      return std::ranges::all_of(value, [this](auto& one) { return unpack(one); });
    } else {
      const auto folded = number();
      if (!folded) return false;
      const std::uint64_t more = *folded >> 1U ^ (0 - (*folded & 1U));
      value = static_cast<T>(static_cast<std::uint64_t>(value) + more);
      if constexpr (DescribedEnum<T>) return static_cast<std::uint64_t>(value) < EnumNames<T>::kNames.size();
      return true;
    }
  }

 private:
  template <class T>
  [[nodiscard]] bool unpack_fields(T& value) {
    constexpr std::size_t kFlags = (T::kFieldCount + 7) / 8;
    if (bytes_.size() < kFlags) return false;
    const std::string_view flags = taken(kFlags);
    std::size_t number = 0;
    bool good = true;
    const auto unpack_field = [&](std::string_view, auto& field) {
      const std::size_t k = number++;
      if (!good || (static_cast<unsigned char>(flags[k / 8]) >> k % 8 & 1U) == 0) return;
      if constexpr (std::is_same_v<std::decay_t<decltype(field)>, bool>)
        field = !field;
      else
        good = unpack(field);
    };
    T::visit(unpack_field, value);
    return good;
  }

  [[nodiscard]] std::string_view taken(std::size_t size) {
    const std::string_view bytes = bytes_.substr(0, size);
    bytes_.remove_prefix(size);
    return bytes;
  }

  [[nodiscard]] std::optional<std::uint64_t> number() {
    std::uint64_t number = 0;
    for (unsigned shift = 0; shift < 64 && !bytes_.empty(); shift += 7) {
      const auto byte = static_cast<unsigned char>(taken(1).front());
      number |= std::uint64_t{byte & 0x7FU} << shift;
      if (byte < 0x80U) return number;
    }
    return std::nullopt;
  }

  std::string_view bytes_;
};

/// The names and kinds of all that a value of this type is made of, in order.
template <class T>
void describe_layout(std::string& text) {
  if constexpr (Described<T>) {
    text.append(T::kTypeName).append("{");
    T::visit(
        [&](std::string_view name, const auto& field) {
          text.append(name).append(":");
          describe_layout<std::decay_t<decltype(field)>>(text);
        },
        T{});
    text += '}';
  } else if constexpr (DescribedEnum<T>) {
    for (const std::string_view name : EnumNames<T>::kNames) text.append(name).append("|");
  } else if constexpr (IsList<T>::value) {
    text += '[';
    describe_layout<typename T::value_type>(text);
  } else if constexpr (std::is_same_v<T, std::string>) {
    text += "text,";
  } else {
    text.append(std::is_same_v<T, double> ? "double"
                : std::is_signed_v<T>     ? "int"
                                          : "count")
        .append(std::to_string(sizeof(T)))
        .append(",");
  }
}

/// A name for how all topics are laid out, another for each other way.
[[nodiscard]] const std::string& packed_layout();

/// The same, of messages of any topic, one behind the other; those before it are kept by who calls, by topic.
using LastOfTopics = std::vector<const Message*>;
void pack(const Message& message, LastOfTopics& last, std::string& bytes);
/// None where the bytes are not one; then nothing more is to be unpacked.
[[nodiscard]] std::optional<Message> unpack(Unpacker& bytes, const LastOfTopics& last);

}  // namespace sealwatch

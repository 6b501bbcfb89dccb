// A message from its bytes as they came over the network (XCDR2 in this machine's byte order, as Cyclone keeps them),
// driven by the field lists of SEALWATCH_FIELDS. The one decoder: it never reads beyond what there is, whatever the bytes
// say. Cyclone's own, which makes the C structs of idl/, does (0.10, a struct whose size is said to be another).
//
//   number, boolean   as it is, aligned to its size, at most to 4
//   enumerator        4 bytes
//   string            4 bytes: its length with the NUL at its end; then so many bytes
//   sequence          4 bytes: how many; then these. Of strings and structs, 4 bytes before: its size
//   struct            4 bytes: its size; then the fields in order
//
// A struct that ends early is that of an older writer: its new fields keep their defaults. What stands behind the fields
// that are known is of a newer one, and passed over.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "sealwatch/core/fields.hpp"

namespace sealwatch::transport {

class FromCdr {
 public:
  /// `bytes`: without the four that name the encoding; they are aligned as from their first.
  explicit FromCdr(std::span<const std::byte> bytes) : bytes_(bytes), end_(bytes.size()) {}

  /// False when the bytes are no such message; it then holds part of one.
  template <Described Message>
  [[nodiscard]] bool read(Message& message) {
    take(message);
    return good_;
  }

  template <class Field>
  void operator()(std::string_view /*field*/, Field& field) {
    if (good_ && at_ < end_) take(field);
  }

 private:
  template <class Number>
  requires std::is_arithmetic_v<Number>
  void take(Number& number) {
    if (!align(std::min(sizeof(Number), kLargestAlignment)) || !has(sizeof(Number))) return;
    if constexpr (std::is_same_v<Number, bool>)
      number = bytes_[at_] != std::byte{0};
    else
      std::memcpy(&number, bytes_.data() + at_, sizeof(Number));
    at_ += sizeof(Number);
  }
  template <DescribedEnum Enum>
  void take(Enum& value) {
    const std::size_t number = count();
    if (number >= EnumNames<Enum>::kNames.size()) return fail();
    value = static_cast<Enum>(number);
  }
  /// It ends at its first NUL, as strings in IDL do.
  void take(std::string& text) {
    const std::size_t size = count();
    if (!has(size)) return;
    const char* const begin = reinterpret_cast<const char*>(bytes_.data()) + at_;
    text.assign(begin, std::find(begin, begin + size, '\0'));
    at_ += size;
  }
  template <class Item>
  void take(std::vector<Item>& items) {
    items.clear();
    if constexpr (std::is_arithmetic_v<Item>) {
      const std::size_t number = count();
      if (number == 0) return;
      if (!align(std::min(sizeof(Item), kLargestAlignment)) || number > (end_ - at_) / sizeof(Item)) return fail();
      items.resize(number);
      std::memcpy(items.data(), bytes_.data() + at_, number * sizeof(Item));
      at_ += number * sizeof(Item);
    } else {
      delimited([&] {
        std::size_t left = count();
        items.reserve(std::min(left, kMostReserved));
        for (; good_ && left > 0; --left) take(items.emplace_back());
      });
    }
  }
  template <Described Struct>
  void take(Struct& content) {
    delimited([&] { Struct::visit(*this, content); });
  }

  /// What `work` reads ends where its size says.
  template <class Work>
  void delimited(const Work& work) {
    const std::size_t size = count();
    if (!has(size)) return;
    const std::size_t outer = end_;
    end_ = at_ + size;
    work();
    at_ = end_;
    end_ = outer;
  }
  [[nodiscard]] std::size_t count() {
    std::uint32_t number = 0;
    take(number);
    return number;
  }
  [[nodiscard]] bool align(std::size_t size) {
    at_ = (at_ + size - 1) / size * size;
    return has(0);
  }
  [[nodiscard]] bool has(std::size_t size) {
    if (good_ && (at_ > end_ || size > end_ - at_)) fail();
    return good_;
  }
  void fail() { good_ = false; }

  static constexpr std::size_t kLargestAlignment = 4;
  /// Whatever the message says how many there are: what it does not hold costs nothing.
  static constexpr std::size_t kMostReserved = 32;
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  std::size_t end_;
  bool good_ = true;
};

}  // namespace sealwatch::transport

// Messages in which every field has a value of its own, for round trips: made from the field lists, so that no field
// can be forgotten. Values count on, so a field that ends up in another's place is noticed.
#pragma once

#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "sealwatch/core/fields.hpp"

namespace sealwatch::test {

/// `length` elements in every sequence: 0 for empty ones.
class Filler {
 public:
  explicit Filler(std::size_t length) : length_(length) {}

  template <class T>
  void operator()(std::string_view name, T& value) {
    fill(name, value);
  }

  template <class T>
  [[gnu::noinline]] void fill(std::string_view name, T& value) {
    ++count_;
    if constexpr (std::is_same_v<T, bool>)
      value = !value;  // the opposite of the default
    else if constexpr (std::is_arithmetic_v<T>)
      value = static_cast<T>(count_) + static_cast<T>(0.25);
    else if constexpr (DescribedEnum<T>)
      value = static_cast<T>((static_cast<std::size_t>(value) + count_ % 2 + 1) % EnumNames<T>::kNames.size());
    else if constexpr (std::is_same_v<T, std::string>)
      value = length_ == 0 ? "" : std::string(name) + " \u00b5\u2126\u6f0f\U0001F6E2 " + std::to_string(count_);
    else if constexpr (Described<T>)
      T::visit(*this, value);
    else
      fill_sequence(name, value);
  }

 private:
  template <class T>
  void fill_sequence(std::string_view name, std::vector<T>& values) {
    values.resize(length_);
    for (T& value : values) fill(name, value);
  }

  std::size_t length_;
  std::uint32_t count_ = 0;
};

template <class T>
[[nodiscard]] T filled(std::size_t length) {
  T message;
  Filler(length).fill("", message);
  return message;
}

}  // namespace sealwatch::test

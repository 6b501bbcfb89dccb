// Fills every field of a message with a value of its own, so that a forgotten or swapped field shows in a round trip.
#pragma once

#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "sealwatch/core/fields.hpp"

namespace sealwatch::testing {

class Filler {
 public:
  /// Sequences get `length` items each.
  explicit Filler(std::size_t length) : length_(length) {}

  template <class T>
  void operator()(std::string_view name, T& value) {
    fill(name, value);
  }

  template <class T>
  void fill(std::string_view name, T& value) {
    ++count_;
    if constexpr (Described<T>) {
      T::visit(*this, value);
    } else if constexpr (std::is_same_v<T, std::string>) {
      value = std::string(name) + " \"\\\n\xC3\xA9 " + std::to_string(count_);
    } else if constexpr (std::is_same_v<T, bool>) {
      value = !value;
    } else if constexpr (std::is_enum_v<T>) {
      value = static_cast<T>((static_cast<std::size_t>(value) + 1) % EnumNames<T>::kNames.size());
    } else if constexpr (std::is_same_v<T, double>) {
      value = 1.0 / 3.0 + static_cast<double>(count_);
    } else if constexpr (std::is_arithmetic_v<T>) {
      value = static_cast<T>(1000 + count_);
    } else {
      value.resize(length_);
      for (auto& item : value) fill(name, item);
    }
  }

 private:
  std::size_t length_;
  std::size_t count_ = 0;
};

template <class T>
T filled(std::size_t length) {
  T message;
  T::visit(Filler(length), message);
  return message;
}

}  // namespace sealwatch::testing

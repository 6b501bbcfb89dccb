// What a plant's derivatives() takes as `extra` where no law adds anything (model/sites.hpp).
//
//   x + None = x,   x * None = None
//
// so that the plant as it is costs what it would without sites.
#pragma once

#include <cstddef>

namespace sealwatch {

/// The absent contribution.
struct None {
  template <class T>
  friend constexpr T operator+(const T& a, None) {
    return a;
  }
  template <class T>
  friend constexpr T operator-(const T& a, None) {
    return a;
  }
  template <class T>
  friend constexpr None operator*(const T&, None) {
    return {};
  }
  friend constexpr None operator+(None, None) { return {}; }
};

struct NoExtra {
  constexpr None operator[](std::size_t) const { return {}; }
};

}  // namespace sealwatch

// Sites: the places in a plant's balances at which laws of the catalogue (model/physics.hpp) add their contribution.
//
// A plant's derivatives() takes what is added at each site, `extra[k]`, as its last argument. NoExtra is the plant as
// it is: its entries are `None`, which adds nothing and costs nothing.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "sealwatch/model/physics.hpp"

namespace sealwatch {

/// The absent contribution: x + None = x, x * None = None.
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

/// Of a site of kind own, whose words are the plant's.
struct SiteSignal {
  std::string_view name, unit;
};

/// One site of a plant. Its index in the plant's table is its place in `extra`.
struct Site {
  std::string_view element;  ///< of the plant's description
  SiteKind kind;
  Feeds feeds = Feeds::anything;  ///< of a command's voltage
  std::string_view unit = {};     ///< of a site of kind own
  std::array<SiteSignal, kSiteSignals> signals = {};
};

/// Whether a law is asked at a site.
[[nodiscard]] inline bool fits(const Law& law, const Site& site) {
  return law.kind == site.kind && (law.element.empty() || law.element == site.element) &&
         (law.feeds == site.feeds || law.feeds == Feeds::anything || site.feeds == Feeds::anything);
}

}  // namespace sealwatch

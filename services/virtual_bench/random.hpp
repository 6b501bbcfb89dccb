// Random numbers of the bench, the same on every machine for the same seed.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <string_view>

#include "sealwatch/forecast/degradation.hpp"

namespace sealwatch::bench {

/// Standard normal numbers by the Box-Muller transform of two uniform ones.
class NormalRandom {
 public:
  explicit NormalRandom(std::uint64_t seed) : uniform_(seed) {}
  [[nodiscard]] double next() {
    if (has_spare_) {
      has_spare_ = false;
      return spare_;
    }
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform_.unit()));  // 1 - unit() is never 0
    const double angle = 2.0 * std::numbers::pi * uniform_.unit();
    spare_ = radius * std::sin(angle);
    has_spare_ = true;
    return radius * std::cos(angle);
  }

 private:
  forecast::UniformRandom uniform_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

/// Seed of a part of something that has a seed: FNV-1a over both, so that streams do not overlap by plain arithmetic.
[[nodiscard]] inline std::uint64_t sub_seed(std::uint64_t seed, std::string_view part) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (int byte = 0; byte < 8; ++byte) hash = (hash ^ ((seed >> (8 * byte)) & 0xffU)) * 1099511628211ULL;
  for (const char letter : part) hash = (hash ^ static_cast<unsigned char>(letter)) * 1099511628211ULL;
  return hash;
}

}  // namespace sealwatch::bench

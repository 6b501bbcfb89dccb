// What hides in a set: drawn from stratum and seed alone, before anything is simulated.
#pragma once

#include <string>
#include <vector>

#include "tests/second_generator/actuator.hpp"
#include "tests/second_generator/random_numbers.hpp"

namespace second_generator {

inline constexpr int kFitted = 4;
inline constexpr int kTests = 6;  // four fitted, two held out

struct Set {
  std::string stratum;
  int seed = 0;
  bool source_sensors = false, differential = false;  // only flow, pressures, position, velocity; p_A - p_B alone
  Values values{};                                    // the true ones
  std::array<double, 7> sensor_gain{}, sensor_offset{};
  std::array<double, kTests> load{};     // load factor of each test
  std::array<double, kTests> changed{};  // factor of the value that changes between tests
  std::vector<Effect> effects;
};

// tolerance: half width within which fixed values are drawn, sensor_tolerance: the same of the sensors' gains and
// offsets, the latter in shares of what the sensor usually shows; both 1. Throws std::invalid_argument
// for a stratum that does not exist.
Set draw_set(const std::string& stratum, int seed, double tolerance, double sensor_tolerance);
const std::vector<std::string>& strata();
int index_of(const std::string& value);

// truth.json
std::string truth(const Set& set);

}  // namespace second_generator

// One test on the bench: a stroke profile, a sampled cascade (position P over shaft speed PI), sensors with their noise.
#pragma once

#include <string>
#include <vector>

#include "tests/second_generator/strata.hpp"

namespace second_generator {

struct Recording {
  std::vector<double> time, voltage;
  std::vector<std::array<double, 7>> samples;  // in the order of kChannels
  std::array<double, 7> noise{};               // standard deviation
  bool noise_known = false;                    // the sidecar states it
  bool hold = false;                           // the voltage is held between samples, else linear
};

// The test of that number (0 to 5) of a set. noise: factor of the sensors' noise, 0 for none.
Recording record(const Set& set, int test, double noise);

}  // namespace second_generator

#include "services/state_detection/baseline.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace sealwatch {
namespace {

constexpr std::size_t kTeachOnly = 3;  // a spread from fewer values says nothing

/// Student's t quantile, 99.9 % two-sided, for 2, 3, ... degrees of freedom; 20 and more take the last.
constexpr std::array kStudent999 = {31.60, 12.92, 8.610, 6.869, 5.959, 5.408, 5.041, 4.781, 4.587, 4.437,
                                    4.318, 4.221, 4.140, 4.073, 4.015, 3.965, 3.922, 3.883, 3.850};

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Half width of the prediction interval of one more value.
double prediction_half_width(const std::vector<double>& values) {
  const double mean = mean_of(values);
  const auto count = static_cast<double>(values.size());
  double sum_of_squares = 0.0;
  for (const double value : values) sum_of_squares += (value - mean) * (value - mean);
  const double std = std::sqrt(sum_of_squares / (count - 1.0));
  const std::size_t index = std::min(values.size() - 3, kStudent999.size() - 1);
  return kStudent999[index] * std * std::sqrt(1.0 + 1.0 / count);
}

}  // namespace

Status BaselineOptions::validate() const {
  if (tests >= static_cast<int>(kTeachOnly)) return {};
  return fail(Error{{}, "tests", std::to_string(tests), "must be at least 3", "a baseline needs a spread"});
}

void Baseline::learn(const std::string& quantity, double value) {
  std::vector<double>& values = values_[quantity];
  if (values.size() < static_cast<std::size_t>(options_.tests)) values.push_back(value);
}

const std::vector<double>* Baseline::learnt(const std::string& quantity) const {
  const auto found = values_.find(quantity);
  return found != values_.end() && found->second.size() >= kTeachOnly ? &found->second : nullptr;
}

double Baseline::centre(const std::string& quantity, double value) const {
  const std::vector<double>* values = learnt(quantity);
  return values == nullptr ? value : mean_of(*values);
}

AlertLimits Baseline::limits(const std::string& quantity, double value, double tolerance) const {
  const std::vector<double>* values = learnt(quantity);
  const double width = values == nullptr ? tolerance : std::max(tolerance, prediction_half_width(*values));
  const double mean = centre(quantity, value);
  const double step = value < mean ? -width : width;
  return {mean + step, mean + 2.0 * step, mean + 3.0 * step};
}

}  // namespace sealwatch

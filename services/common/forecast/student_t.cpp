#include "sealwatch/forecast/student_t.hpp"

#include <boost/math/distributions/students_t.hpp>
#include <cassert>
#include <map>
#include <utility>

namespace sealwatch::forecast {
namespace {

constexpr std::size_t kMostKnown = 20000;  // 29 levels times all window lengths up to 240, with room

}  // namespace

double student_t_quantile(double probability, int degrees_of_freedom) {
  assert(probability > 0.0 && probability < 1.0 && degrees_of_freedom >= 1);
  // Forecasts ask for the same few dozen levels over and over, and a quantile is a search that takes microseconds.
  thread_local std::map<std::pair<int, double>, double> known;
  if (known.size() > kMostKnown) known.clear();
  const auto [entry, is_new] = known.try_emplace({degrees_of_freedom, probability}, 0.0);
  if (is_new)
    entry->second =
        boost::math::quantile(boost::math::students_t_distribution<double>(degrees_of_freedom), probability);
  return entry->second;
}

double student_t_probability(double value, int degrees_of_freedom) {
  assert(degrees_of_freedom >= 1);
  return boost::math::cdf(boost::math::students_t_distribution<double>(degrees_of_freedom), value);
}

}  // namespace sealwatch::forecast

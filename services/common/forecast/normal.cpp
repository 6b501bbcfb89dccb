#include "sealwatch/forecast/normal.hpp"

#include <boost/math/special_functions/erf.hpp>
#include <cassert>
#include <cmath>

namespace sealwatch::forecast {

double normal_density(double z) {
  constexpr double kInverseRootTwoPi = 0.39894228040143267794;
  return kInverseRootTwoPi * std::exp(-0.5 * z * z);
}

double normal_probability(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

double normal_quantile(double probability) {
  assert(probability > 0.0 && probability < 1.0);
  return -std::sqrt(2.0) * boost::math::erfc_inv(2.0 * probability);
}

}  // namespace sealwatch::forecast

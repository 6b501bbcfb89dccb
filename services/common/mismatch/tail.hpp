// Tail of the chi-squared distribution, fast for one and two degrees of freedom.
#pragma once

#include <boost/math/special_functions/gamma.hpp>
#include <cmath>

namespace sealwatch::mismatch {

/// P(chi^2 with that many degrees of freedom > statistic).
[[nodiscard]] inline double chi_squared_tail(double statistic, double degrees_of_freedom) {
  if (!(statistic > 0.0)) return 1.0;
  if (degrees_of_freedom == 1.0) return std::erfc(std::sqrt(0.5 * statistic));
  if (degrees_of_freedom == 2.0) return std::exp(-0.5 * statistic);
  return boost::math::gamma_q(0.5 * degrees_of_freedom, 0.5 * statistic);
}

}  // namespace sealwatch::mismatch

#include "sealwatch/forecast/student_t.hpp"

#include <boost/math/distributions/students_t.hpp>
#include <cassert>

namespace sealwatch::forecast {

double student_t_quantile(double probability, int degrees_of_freedom) {
  assert(probability > 0.0 && probability < 1.0 && degrees_of_freedom >= 1);
  return boost::math::quantile(boost::math::students_t_distribution<double>(degrees_of_freedom), probability);
}

double student_t_probability(double value, int degrees_of_freedom) {
  assert(degrees_of_freedom >= 1);
  return boost::math::cdf(boost::math::students_t_distribution<double>(degrees_of_freedom), value);
}

}  // namespace sealwatch::forecast

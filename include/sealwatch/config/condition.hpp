// The condition of what wears in an asset, theta: a line through two values of the parameter that wears, or of its
// logarithm (MODEL section 4).
//
//   theta = 0.6 + 0.4 (s(p) - s(p_60)) / (s(p_100) - s(p_60)),   s(p) = p or ln p
#pragma once

#include <cmath>
#include <string>

namespace sealwatch {

struct ConditionSetting {
  std::string parameter;    ///< of the plant's model: "R_CL"
  double at_100 = 0.0;      ///< the parameter as new, theta = 1
  double at_60 = 0.0;       ///< at theta = 0.6
  double threshold = 0.60;  ///< theta at which it has failed
  bool logarithmic = false;
  std::string unit = {};  ///< of the parameter
  std::string part = {};  ///< what wears: "piston seal"

  /// Whether the parameter is a positive scale.
  [[nodiscard]] bool is_positive() const { return at_100 > 0.0 && at_60 > 0.0; }

  [[nodiscard]] double condition(double value) const {
    return 0.6 + 0.4 * (scaled(value) - scaled(at_60)) / (scaled(at_100) - scaled(at_60));
  }
  /// The parameter at a condition.
  [[nodiscard]] double value(double condition) const {
    const double at = scaled(at_60) + (condition - 0.6) / 0.4 * (scaled(at_100) - scaled(at_60));
    return logarithmic ? std::exp(at) : at;
  }
  /// Standard error of theta for one of the parameter: the slope there.
  [[nodiscard]] double condition_std(double value, double std_error) const {
    return 0.4 * std_error / std::abs(scaled(at_100) - scaled(at_60)) / (logarithmic ? value : 1.0);
  }

 private:
  [[nodiscard]] double scaled(double value) const { return logarithmic ? std::log(value) : value; }
};

}  // namespace sealwatch

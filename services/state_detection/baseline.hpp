// The asset's own baseline: what its first tests after commissioning or replacement looked like.
//
//   mean, s : mean and standard deviation of a quantity over its first k <= K passed tests in which it was normal
//   width   = max(tolerance, t_{k-1} s sqrt(1 + 1/k))     prediction interval of one more test
//   limits  = mean +- width (advisory), +- 2 width (warning), +- 3 width (alarm), on the side that the value is on
//
// t_{k-1} is Student's 99.9 % two-sided quantile: by chance alone one test in a thousand leaves the interval. The
// tolerance keeps a baseline that happens to be very quiet from calling an unimportant change a deviation. The first
// three tests only teach: their limits are centred on their own value.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/core/result.hpp"

namespace sealwatch {

struct BaselineOptions {
  int tests = 12;  ///< K: a year of monthly tests
  [[nodiscard]] Status validate() const;
};

class Baseline {
 public:
  explicit Baseline(const BaselineOptions& options) : options_(options) {}
  /// One passed test's value; ignored when K are known already.
  void learn(const std::string& quantity, double value);
  /// Limits for `value` on its side of the baseline; `tolerance` > 0 in the quantity's unit.
  [[nodiscard]] AlertLimits limits(const std::string& quantity, double value, double tolerance) const;
  /// Mean of what was learnt, or `value` while there is too little.
  [[nodiscard]] double centre(const std::string& quantity, double value) const;

 private:
  [[nodiscard]] const std::vector<double>* learnt(const std::string& quantity) const;

  BaselineOptions options_;
  std::map<std::string, std::vector<double>> values_;
};

}  // namespace sealwatch

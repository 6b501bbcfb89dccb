// Alert regions with hysteresis and delay.
//
//   raw region     r_k : where the value of test k stands between the limits advisory, warning, alarm
//   eased region   e_k : the same with each limit moved by margin * |warning - advisory| towards normal, so e_k >= r_k
//   region         R_k : worsens to min(r_{k-n+1} .. r_k) when all these n exceed R_{k-1};
//                        recovers to max(e_{k-m+1} .. e_k) when all these m are below R_{k-1}; else stays
//
// n tests in a row to worsen keep one month's noise from raising an alert; m > n tests to recover and the margin keep a
// value that wanders about a limit from flapping. A test in which the quantity could not be had counts neither way.
#pragma once

#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/core/result.hpp"
#include "sealwatch/message/state_detection.hpp"

namespace sealwatch {

struct RegionOptions {
  int worsen_after_tests = 2;   ///< n: a second monthly test confirms
  int recover_after_tests = 3;  ///< m: a quarter of a year without the deviation
  double margin = 0.2;          ///< share of the step between advisory and warning
  [[nodiscard]] Status validate() const;
};

/// Region of `value` alone: beyond a limit is above it, or below it where alarm < advisory.
[[nodiscard]] AlertRegion region_of(double value, const AlertLimits& limits);

/// Follows one quantity of one asset over its tests.
class RegionFilter {
 public:
  explicit RegionFilter(const RegionOptions& options) : options_(options) {}
  /// Takes a test's value and limits from `judgement` and fills in raw_region, region and tests_in_raw_region.
  void update(RegionJudgement& judgement);
  /// Fills in the regions without taking the test into account: its raw region, and the region as it was.
  void look(RegionJudgement& judgement) const;
  [[nodiscard]] AlertRegion region() const { return region_; }

 private:
  struct Regions {
    AlertRegion raw;
    AlertRegion eased;
  };
  void follow();

  RegionOptions options_;
  std::vector<Regions> recent_;  // oldest first, no more than max(n, m)
  AlertRegion region_ = AlertRegion::normal;
  int tests_in_raw_region_ = 0;
};

}  // namespace sealwatch

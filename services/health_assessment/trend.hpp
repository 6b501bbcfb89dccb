// Trend of the health grade over the last tests.
//
//   grade(t) = g_0 + slope t,   weights w_k = exp(-(t_now - t_k) / 12 months)       the last year counts most
//   slope    = sum w (t - t_w)(g - g_w) / S,   S = sum w (t - t_w)^2,   t_w, g_w weighted means
//   std      = sqrt(s^2 sum w^2 (t - t_w)^2) / S,   s^2 = sum r^2 / (n - 2)        equal variance of all grades
#pragma once

#include <optional>
#include <vector>

#include "sealwatch/core/time.hpp"

namespace sealwatch {

struct GradeAt {
  UtcTime time;
  double grade = 1.0;
};

struct Trend {
  double slope_per_year = 0.0;
  double std_per_year = 0.0;
};

/// Nothing for fewer than six grades or when they are all of one time.
[[nodiscard]] std::optional<Trend> trend_of(const std::vector<GradeAt>& grades);

}  // namespace sealwatch
